"""Measures what docs/figures/planner.py fits, with the program `lightwell`, into planner_data.json.

Below `work`: chart*/ (errors and times of all views; of times the point with more frames counts, of equals the quicker, of errors the last folder's), seeds*/ (errors of further
sample sets), sizes_*/ (times at other sizes), rival/ (path tracing), probes.json, rsm_sizes.json, launches.json. Every command goes on where it was stopped. Over 300 lines: a quarter is the list of candidates.
"""
import json
import pathlib
import re
import statistics
import subprocess

from planner_model import DATA, PROBES

SIZE, BLOCK = (1280, 720), 10
SCENES = ["cornell", "basic", "rooms", "cornell_original", "sponza_crytek", "sponza_dabrovic", "sibenik", "living_room", "wooden_staircase",
          "breakfast_room", "level_zdm2", "bunny_corner"]
SHARED = SCENES[3:]  # the large ones, of which the rival is asked first
SEEDS = (1, 2)  # beside 0: of VPLs drawn by chance a single set tells as much of its luck as of the configuration
UNSURE, MORE_SEEDS = ["living_room", "level_zdm2", "breakfast_room", "basic"], (3, 4)  # where single sets lie farthest apart, a factor of 1.2 to 2
SIZES, SIZED = [(640, 360), (1920, 1080)], ["cornell", "sibenik"]
RSM_SIZES, RSM_USUAL = [256, 1024], 512

# What could be on the front of error and time somewhere, from the sweeps in docs/accuracy.md and by trial. All are measured in every
# view; the table has those that were near the front of one.
CANDIDATES = """
rsm vpls=64 resolution=quarter
rsm vpls=64 resolution=half
rsm resolution=quarter
rsm resolution=half
rsm
rsm visibility=voxel resolution=quarter
rsm visibility=voxel resolution=half
ssvp vpls=64 clusters=2 map_size=64 bounces=1 resolution=quarter
ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=quarter
ssvp clusters=4 map_size=64 resolution=quarter
ssvp resolution=quarter
ssvp bounces=4 resolution=quarter
ssvp clusters=16 resolution=quarter
ssvp clusters=16 visibility=strict resolution=quarter
ssvp clusters=16 bounces=4 resolution=quarter
ssvp clusters=16 visibility=strict bounces=4 resolution=quarter
ssvp clusters=16 bounces=4 shadowed_bounces=1 resolution=quarter
ssvp vpls=512 clusters=16 bounces=4 resolution=quarter
ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=quarter
ssvp vpls=512 clusters=16 bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 clusters=16 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 clusters=32 bounces=4 resolution=quarter
ssvp vpls=512 clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict resolution=quarter
ssvp vpls=1024 clusters=64 bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 clusters=64 map_size=256 bounces=4 resolution=quarter
ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=half
ssvp vpls=64 clusters=4 map_size=64 second_vpls=16 resolution=half
ssvp resolution=half
ssvp bounces=4 resolution=half
ssvp clusters=16 resolution=half
ssvp clusters=16 bounces=4 resolution=half
ssvp vpls=512 clusters=16 bounces=4 resolution=half
ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=half
ssvp clusters=32 resolution=half
ssvp clusters=32 bounces=4 resolution=half
ssvp vpls=1024 clusters=32 bounces=4 resolution=half
ssvp vpls=1024 clusters=32 visibility=strict bounces=4 resolution=half
ssvp vpls=1024 clusters=32 bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict resolution=half
ssvp vpls=1024 clusters=64 bounces=4 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=half
ssvp vpls=1024 clusters=64 bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 clusters=64 map_size=256 bounces=4 resolution=half
ssvp
ssvp clusters=16 bounces=4
ssvp vpls=1024 clusters=32 bounces=4
ssvp vpls=1024 clusters=32 visibility=strict bounces=4
ssvp vpls=1024 clusters=64 bounces=4
ssvp vpls=512 sampling=view clusters=16 visibility=strict resolution=quarter
ssvp vpls=1024 sampling=view clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=half
lpv transport=sweep size=16 directions=96 resolution=half
lpv transport=sweep size=16 directions=96 bounces=4 resolution=half
cone_tracing size=32 cones=6 bounces=0 resolution=quarter
cone_tracing size=32 cones=9 bounces=0 resolution=quarter
cone_tracing size=64 cones=6 bounces=0 resolution=quarter
screen_space samples=16
screen_space
horizon directions=8
horizon
ao samples=8 resolution=half
fallback first=screen_space second=ssvp first.samples=16 second.clusters=16 second.bounces=4 second.resolution=half
fallback first=horizon second=ssvp first.reach=0.25 first.directions=8 second.clusters=16 second.bounces=4 second.resolution=half
fallback first=horizon second=ssvp first.directions=8 second.bounces=3 second.resolution=half
fallback first=screen_space second=cone_tracing first.samples=16 second.size=32 second.cones=6 second.bounces=0 second.resolution=quarter
fallback first=screen_space second=rsm first.samples=16 second.visibility=voxel second.resolution=half
""".strip().splitlines()
# Scenes of few triangles and of many, for what a map takes to draw; of how many maps.
MAPPED, MAPS = ["rooms", "bunny_corner", "sibenik", "sponza_crytek"], 16
# A point alone needs a parameter: one at its default.
ALONE = {"rsm": "vpls=256", "ssvp": "vpls=256", "screen_space": "samples=64", "horizon": "steps=2"}
RIVALS = [f"rival,bounces=2,spp={spp},resolution={resolution}" for spp in (1, 2, 4, 8) for resolution in ("full", "half", "quarter")]


def parted(candidate):
    technique, _, settings = candidate.partition(" ")
    return technique, settings


def variant(candidate):
    technique, settings = parted(candidate)
    return ",".join([technique, *(settings or ALONE[technique]).split()])


def measure(program, work):
    def lightwell(*arguments, capture=True):
        result = subprocess.run([program, *map(str, arguments)], capture_output=capture, text=True)
        if result.returncode:
            raise SystemExit(f"lightwell {arguments[0]} failed: {(result.stderr or '').strip()}")
        return result.stdout

    def chart(folder, techniques, size, frames, *more):
        lightwell("chart", "--out", work / folder, "--size", f"{size[0]}x{size[1]}", "--judge-one-of", BLOCK, "--picture-noise", 0, "--no-report",
                  "--frames", frames, "--techniques", *techniques, *more, capture=False)

    all_of = list(map(variant, CANDIDATES))
    truth = ["--noise", "3e-3", "--truth-seconds", 120]
    chart("chart", all_of, SIZE, 11, "--scenes", *SCENES, *truth)
    drawn = [c for c in CANDIDATES if is_drawn(c)]
    for seed in SEEDS:
        chart(f"seeds{seed}", [f"{variant(c)},seed={seed}" for c in drawn], SIZE, 1, "--scenes", *SCENES, *truth)
    for seed in MORE_SEEDS:
        chart(f"seeds{seed}", [f"{variant(c)},seed={seed}" for c in drawn], SIZE, 1, "--scenes", *UNSURE, *truth)
    for size in SIZES:
        chart(f"sizes_{size[1]}", all_of, size, 11, "--scenes", *SIZED, "--cameras", "first", "--noise", "1e3")
    chart("rival", RIVALS, SIZE, 1, "--scenes", *SHARED, "--cameras", "first", *truth)
    views = json.loads((work / "chart/results.json").read_text())["views"]
    (work / "probes.json").write_text(json.dumps([probe(lightwell, v) for v in views]))
    (work / "rsm_sizes.json").write_text(json.dumps([
        {"technique": t, "rsm_size": n, "ms": json.loads(lightwell("render", "cornell", "--technique", t, "--set", "resolution=half", "--rsm-size", n,
                                                                   "--size", "1280x720", "--frames", 11, "--json"))["wall_ms"]}
        for t in ("rsm", "ssvp") for n in RSM_SIZES]))
    (work / "maps.json").write_text(json.dumps(maps(program)))
    (work / "launches.json").write_text(json.dumps({c: launches(lightwell, c) for c in CANDIDATES}))
    (work / "rates.json").write_text(json.dumps([json.loads(lightwell("devices", "--probe", "--json"))[0] for _ in range(4)]))


def probe(lightwell, view):
    plan = json.loads(lightwell("plan", view["scene"], "--camera", view["camera"], "--budget-ms", 33, "--json"))
    named = {name: plan["probes"][re.sub("[A-Z]", lambda letter: "_" + letter.group().lower(), name)] for name in PROBES}
    return {"scene": view["scene"], "camera": view["camera"], "probes": named, "triangles": plan["triangles"]}


def maps(program):
    """Milliseconds that a first frame's maps take, of 128 x 128 texels each: the least of three."""
    def lightwell(*arguments):
        return json.loads(subprocess.run([program, *map(str, arguments), "--json"], capture_output=True, text=True, check=True).stdout)

    def once(scene):
        frame = lightwell("render", scene, "--technique", "ssvp", "--set", f"clusters={MAPS}", "bounces=1", "--size", "320x180", "--frames", 1, "--warmup", 0)
        return sum(p["ms"] for p in frame["passes"] if p["name"].startswith("paraboloid_map."))

    return [{"scene": scene, "triangles": lightwell("plan", scene, "--budget-ms", 33)["triangles"], "maps": MAPS,
             "ms": rounded(min(once(scene) for _ in range(3)))} for scene in MAPPED]


def put_maps(program):
    data = json.loads(DATA.read_text())
    data["maps"] = maps(program)
    DATA.write_text(compact(data), encoding="utf-8")


def launches(lightwell, candidate):
    technique, settings = parted(candidate)
    setting = ["--set", *settings.split()] if settings else []
    frame = json.loads(lightwell("render", "cornell", "--technique", technique, *setting, "--size", "160x96", "--frames", 1, "--json"))
    return sum(p["launches"] for p in frame["passes"])


# ------------------------------------------------------------------------------------- to one file

def is_drawn(candidate):
    return parted(candidate)[0] in ("rsm", "ssvp")


def is_point_of(point, candidate, seed=0):
    technique, settings = parted(candidate)
    if point["technique"] != technique:
        return False
    wanted = dict(s.split("=") for s in settings.split())
    if is_drawn(candidate):
        wanted["seed"] = str(seed)
    names = {True: "on", False: "off"}
    values = {k: names[v] if isinstance(v, bool) else v if isinstance(v, str) else f"{v:g}" for k, v in point["parameters"].items()}
    changed = [] if point["settings"] == "defaults" else [s.split("=")[0] for s in point["settings"].split()]
    return all(values.get(k) == v for k, v in wanted.items()) and all(k in wanted for k in changed)


def read_points(folder):
    data = json.loads((folder / "results.json").read_text())
    return data, data["points"]


def time_of(point, threads):
    """Processor time over threads: other work lengthens the clock's. Times what the clock shows beyond it where nothing else ran."""
    return point["processor_ms"]["median"] / threads


def noiseless(errors):
    """The truth's noise adds to every squared error; below a fifth of it nothing is told."""
    return max(errors["relMSE"] - errors["noise"], 0.2 * errors["noise"], 1e-3)


def collect(work, date):
    charts = [read_points(p.parent) for p in sorted(work.glob("chart*/results.json"))]
    header = charts[0][0]["header"]
    threads = int(header["versions"]["threads"])
    probed = json.loads((work / "probes.json").read_text())
    index = {(v["scene"], v["camera"]): i for i, v in enumerate(probed)}
    points = {}
    for _, some in charts:
        for p in some:
            for c, candidate in enumerate(CANDIDATES):
                if is_point_of(p, candidate):
                    points.setdefault((index[p["scene"], p["camera"]], c), []).append(p)
    further = further_seeds(work, index)
    quiet = [p["ms"]["median"] / time_of(p, threads) for some in points.values() for p in some]
    beyond = statistics.median(q for q in quiet if q < 1.15)
    errors, ms = ([[None] * len(CANDIDATES) for _ in probed] for _ in range(2))
    drift = drifts(points, threads, len(probed))
    for (v, c), some in points.items():
        most = max(p["frames"] for p in some)
        # Of logarithms: single sets lie up to a decade off where few pixels rule the error.
        errors[v][c] = rounded(statistics.geometric_mean([noiseless(some[-1]["errors"]["all"]), *further.get((v, c), [])]))
        ms[v][c] = rounded(min(time_of(p, threads) for p in some if p["frames"] == most) * beyond * drift(v, most))
    launched = json.loads((work / "launches.json").read_text()) if (work / "launches.json").exists() else {}
    rates = json.loads((work / "rates.json").read_text())
    rate = {"multiply_add_gflops": rounded(max(r["multiply_add_gflops"] for r in rates)), "bandwidth_GBps": rounded(max(r["bandwidth_GBps"] for r in rates)),
            "launch_us": rounded(statistics.median(r["launch_us"] for r in rates), 3)}
    whole = [c for c in range(len(CANDIDATES)) if all(row[c] is not None for row in errors)]
    for c in set(range(len(CANDIDATES))) - set(whole):
        print(f"left out, for it is not measured in every view: {CANDIDATES[c]}")
    pick = lambda row: [row[c] for c in whole]  # noqa: E731
    result = {"date": date, "device": header["device"]["name"], "driver": header["device"]["driver"], "cpu": header["versions"]["cpu"],
              "threads": threads, "seeds": 1 + len(SEEDS), "more_seeds": {scene: 1 + len(SEEDS + MORE_SEEDS) for scene in UNSURE}, "size": list(SIZE), "judged_block": BLOCK, "rsm_texels": RSM_USUAL ** 2,
              "clock_over_processor": round(beyond, 4), "rates": rate,
              "candidates": [{"technique": parted(c)[0], "settings": parted(c)[1], "launches": launched.get(c, 0)} for c in pick(CANDIDATES)],
              "views": [{**v, "noise": noise_of(charts, v)} for v in probed],
              "errors": list(map(pick, errors)), "ms": list(map(pick, ms)),
              "sizes": [{**entry, "ms": pick(entry["ms"])} for entry in sizes(work, threads, beyond)], "ms_per_megatexel": per_megatexel(work), "maps": json.loads((work / "maps.json").read_text()), "rival": rivals(work, threads, beyond)}
    DATA.write_text(compact(result), encoding="utf-8")
    print(DATA)


def further_seeds(work, index):
    """Errors of the sample sets beside the first, by view and candidate."""
    result = {}
    for seed in SEEDS + MORE_SEEDS:
        for p in (p for folder in sorted(work.glob(f"seeds{seed}*/results.json")) for p in read_points(folder.parent)[1]):
            for c, candidate in enumerate(CANDIDATES):
                if is_drawn(candidate) and is_point_of(p, candidate, seed):
                    result.setdefault((index[p["scene"], p["camera"]], c), []).append(noiseless(p["errors"]["all"]))
    return result


def drifts(points, threads, views):
    """A shared machine is not as quick at all hours: in each view, points of fewer frames are brought to the speed of the ones of most frames, by
    the median ratio of what was measured both times."""
    most = max(p["frames"] for some in points.values() for p in some)
    ratios = [{} for _ in range(views)]
    for (v, _), some in points.items():
        best = [time_of(p, threads) for p in some if p["frames"] == most]
        for p in some:
            if best and p["frames"] < most:
                ratios[v].setdefault(p["frames"], []).append(min(best) / time_of(p, threads))
    return lambda v, frames: statistics.median(ratios[v][frames]) if len(ratios[v].get(frames, ())) >= 3 else 1.0


def rounded(value, digits=4):
    return float(f"{value:.{digits}g}")


def noise_of(charts, view):
    noises = [p["errors"]["all"]["noise"] for _, some in charts for p in some if (p["scene"], p["camera"]) == (view["scene"], view["camera"])]
    return rounded(min(noises), 3)


def sizes(work, threads, beyond):
    result = []
    for folder in sorted(work.glob("sizes_*")):
        of_view = {}
        for p in read_points(folder)[1]:
            row = of_view.setdefault((p["scene"], p["camera"], tuple(p["size"])), [None] * len(CANDIDATES))
            for c, candidate in enumerate(CANDIDATES):
                if is_point_of(p, candidate):
                    row[c] = rounded(time_of(p, threads) * beyond)
        result += [{"scene": s, "camera": k, "size": list(z), "ms": row} for (s, k, z), row in of_view.items()]
    return result


def per_megatexel(work):
    by_technique = {}
    for entry in json.loads((work / "rsm_sizes.json").read_text()):
        by_technique.setdefault(entry["technique"], {})[entry["rsm_size"]] = entry["ms"]
    low, high = RSM_SIZES
    return rounded(statistics.mean((t[high] - t[low]) / ((high * high - low * low) * 1e-6) for t in by_technique.values()), 3)


def rivals(work, threads, beyond):
    return [{"scene": p["scene"], "camera": p["camera"], "bounces": p["parameters"]["bounces"], "spp": p["parameters"]["spp"],
             "resolution": p["parameters"]["resolution"], "ms": rounded(time_of(p, threads) * beyond), "all": rounded(noiseless(p["errors"]["all"]))}
            for folder in sorted(work.glob("rival*/results.json")) for p in read_points(folder.parent)[1]]


def compact(result):
    """One line for each view, candidate and row: a change is a change of few lines."""
    lines = []
    for key, value in result.items():
        if isinstance(value, list) and value and isinstance(value[0], (dict, list)):
            inner = ",\n  ".join(json.dumps(v, separators=(",", ":")) for v in value)
            lines.append(f'"{key}": [\n  {inner}\n ]')
        else:
            lines.append(f'"{key}": {json.dumps(value)}')
    return "{\n " + ",\n ".join(lines) + "\n}\n"
