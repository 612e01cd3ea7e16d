"""Measures what docs/figures/planner.py fits, with the program `lightwell`, into planner_data.json.

Below `work`: chart*/ (errors and times of all views; of times the point with more frames counts, of equals the quicker, of errors the last folder's), seeds*/ (errors of further
sample sets), train*/ and train_probes.json (of made-up scenes), sizes_*/ (times at other sizes), rival*/ (path tracing, a folder for each sample set), probes.json, rsm_sizes.json, launches.json, maps.json, rates.json; made/ has the made-up scenes themselves. Every command goes on where it was stopped.
"""
import json
import pathlib
import re
import statistics

import planner_scenes
from planner_candidates import CANDIDATES, barred, is_drawn, parted, variant
from planner_model import COVERAGE, DATA, PROBES
from program import caller

SIZE, BLOCK = (1280, 720), 10
TRUTH = ["--noise", "3e-3", "--truth-seconds", 120]
KEPT = [*TRUTH, "--kept-truths"]  # of the first chart: every further one would trace on where that noise was not reached
SCENES = ["cornell", "basic", "rooms", "cornell_original", "sponza_crytek", "sponza_dabrovic", "sibenik", "living_room", "wooden_staircase",
          "breakfast_room", "level_zdm2", "bunny_corner"]
SHARED = SCENES[3:]  # the large ones, of which the rival is asked first
SEEDS = (1, 2)  # beside 0: of VPLs drawn by chance a single set tells as much of its luck as of the configuration
UNSURE, MORE_SEEDS = ["living_room", "level_zdm2", "breakfast_room", "basic"], (3, 4, 5, 6, 7, 8)  # where single sets lie farthest apart, a factor of 1.2 to 2
SIZES, SIZED = [(640, 360), (1920, 1080)], ["cornell", "sibenik"]
RSM_SIZES, RSM_USUAL = [256, 1024], 512
# Made-up scenes (planner_scenes.py) teach errors, of the techniques that the table may hold. Noisier truths do: a single error matters little there.
TAUGHT, MADE_TRUTH = ("rsm", "ssvp", "screen_space", "horizon"), ["--noise", "1e-2", "--truth-seconds", 40]
# Scenes of few triangles and of many, for what a map takes to draw; of how many maps.
MAPPED, MAPS = ["rooms", "bunny_corner", "sibenik", "sponza_crytek"], 16
# By chance as the VPLs are, and judged alike: the mean of as many sets. A single set's line would be that of its luckiest points.
RIVALS = [f"rival,bounces=2,spp={spp},resolution={resolution}" for spp in (1, 2, 4, 8) for resolution in ("full", "half", "quarter")]


def charter(lightwell, work):
    """chart(folder below `work`, techniques, size, frames, further options); of no techniques nothing."""
    def chart(folder, techniques, size, frames, *more):
        if techniques:
            lightwell("chart", "--out", work / folder, "--size", f"{size[0]}x{size[1]}", "--judge-one-of", BLOCK, "--picture-noise", 0, "--no-report",
                      "--frames", frames, "--techniques", *techniques, *more, shown=True)

    return chart


def is_taught(candidate):
    return parted(candidate)[0] in TAUGHT and "voxel" not in candidate and candidate not in barred(CANDIDATES)


def of_set(candidates, seed):
    return [f"{variant(c)},seed={seed}" if is_drawn(c) else variant(c) for c in candidates if is_drawn(c) or seed == 0]


def chart_errors(chart, rows, made):
    """Of sample sets after the first in all views, of all sets in made-up scenes, and of path tracing where all rows are asked."""
    for seed in SEEDS:
        chart(f"seeds{seed}", of_set(rows, seed), SIZE, 1, "--scenes", *SCENES, *KEPT)
    for seed in MORE_SEEDS:
        chart(f"seeds{seed}", of_set(rows, seed), SIZE, 1, "--scenes", *UNSURE, *KEPT)
    for seed in (0, *SEEDS):
        chart(f"train{seed}", of_set(filter(is_taught, rows), seed), SIZE, 1, "--scenes", *made, *MADE_TRUTH, *([] if seed == 0 else ["--kept-truths"]))
        if len(rows) == len(CANDIDATES):
            chart(f"rival{seed}", [f"{r},seed={seed}" for r in RIVALS], SIZE, 1, "--scenes", *SHARED, "--cameras", "first", *KEPT)


def measure(program, work):
    lightwell = caller(program)
    chart = charter(lightwell, work)
    all_of = list(map(variant, CANDIDATES))
    chart("chart", all_of, SIZE, 11, "--scenes", *SCENES, *TRUTH)
    made = planner_scenes.write(work / "made")
    chart_errors(chart, CANDIDATES, made)
    for size in SIZES:
        chart(f"sizes_{size[1]}", all_of, size, 11, "--scenes", *SIZED, "--cameras", "first", "--noise", "1e3")
    (work / "train_probes.json").write_text(json.dumps([probe(lightwell, {"scene": path, "camera": "camera"}) for path in made]))
    views = json.loads((work / "chart/results.json").read_text())["views"]
    (work / "probes.json").write_text(json.dumps([probe(lightwell, v) for v in views]))
    (work / "rsm_sizes.json").write_text(json.dumps([
        {"technique": t, "rsm_size": n, "ms": json.loads(lightwell("render", "cornell", "--technique", t, "--set", "resolution=half", "--rsm-size", n,
                                                                   "--size", "1280x720", "--frames", 11, "--json"))["wall_ms"]}
        for t in ("rsm", "ssvp") for n in RSM_SIZES]))
    (work / "maps.json").write_text(json.dumps(maps(lightwell)))
    (work / "launches.json").write_text(json.dumps({c: launches(lightwell, c) for c in CANDIDATES}))
    (work / "rates.json").write_text(json.dumps([json.loads(lightwell("devices", "--probe", "--json"))[0] for _ in range(4)]))


def probe(lightwell, view):
    plan = json.loads(lightwell("plan", view["scene"], "--camera", view["camera"], "--budget-ms", 33, "--json"))
    named = {name: plan["probes"][re.sub("[A-Z]", lambda letter: "_" + letter.group().lower(), name)] for name in (*PROBES, COVERAGE)}
    return {"scene": pathlib.Path(view["scene"]).stem, "camera": view["camera"], "probes": named, "triangles": plan["triangles"]}


def maps(lightwell):
    """Milliseconds that a first frame's maps take, of 128 x 128 texels each: the least of three."""
    def once(scene):
        frame = json.loads(lightwell("render", scene, "--technique", "ssvp", "--set", f"clusters={MAPS}", "bounces=1", "--size", "320x180", "--frames", 1,
                                     "--warmup", 0, "--json"))
        return sum(p["ms"] for p in frame["passes"] if p["name"].startswith("paraboloid_map."))

    return [{"scene": scene, "triangles": json.loads(lightwell("plan", scene, "--budget-ms", 33, "--json"))["triangles"], "maps": MAPS,
             "ms": rounded(min(once(scene) for _ in range(3)))} for scene in MAPPED]


def put_maps(program):
    data = json.loads(DATA.read_text())
    data["maps"] = maps(caller(program))
    DATA.write_text(compact(data), encoding="utf-8")


def launches(lightwell, candidate):
    technique, settings = parted(candidate)
    setting = ["--set", *settings.split()] if settings else []
    frame = json.loads(lightwell("render", "cornell", "--technique", technique, *setting, "--size", "160x96", "--frames", 1, "--json"))
    return sum(p["launches"] for p in frame["passes"])


# ------------------------------------------------------------------------------------- to one file

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
    further = seed_errors(sorted(work.glob("seeds[0-9]*/results.json")), index)
    quiet = [p["ms"]["median"] / time_of(p, threads) for some in points.values() for p in some]
    beyond = statistics.median(q for q in quiet if q < 1.15)
    errors, ms = ([[None] * len(CANDIDATES) for _ in probed] for _ in range(2))
    drift = drifts(points, threads, len(probed))
    for (v, c), some in points.items():
        most = max(p["frames"] for p in some)
        # Of logarithms: single sets lie up to a decade off where few pixels rule the error.
        errors[v][c] = rounded(statistics.geometric_mean([noiseless(some[-1]["errors"]["all"]), *further.get((v, c), {}).values()]))
        ms[v][c] = rounded(min(time_of(p, threads) for p in some if p["frames"] == most) * beyond * drift(v, most))
    share_times(ms)
    made = made_up(work)
    launched = json.loads((work / "launches.json").read_text())
    sets = {scene: 1 + max(len(of) for (v, _), of in further.items() if probed[v]["scene"] == scene) for scene in SCENES}
    usual = min(sets.values())
    rates = json.loads((work / "rates.json").read_text())
    rate = {"multiply_add_gflops": rounded(max(r["multiply_add_gflops"] for r in rates)), "bandwidth_GBps": rounded(max(r["bandwidth_GBps"] for r in rates)),
            "launch_us": rounded(statistics.median(r["launch_us"] for r in rates), 3)}
    whole = [c for c in range(len(CANDIDATES)) if all(row[c] is not None for row in errors)]
    for c in set(range(len(CANDIDATES))) - set(whole):
        print(f"left out, for it is not measured in every view: {CANDIDATES[c]}")
    pick = lambda row: [row[c] for c in whole]  # noqa: E731
    result = {"date": date, "device": header["device"]["name"], "driver": header["device"]["driver"], "cpu": header["versions"]["cpu"],
              "threads": threads, "seeds": usual, "more_seeds": {scene: n for scene, n in sets.items() if n > usual}, "size": list(SIZE), "judged_block": BLOCK, "rsm_texels": RSM_USUAL ** 2,
              "clock_over_processor": round(beyond, 4), "rates": rate,
              "candidates": [{"technique": parted(c)[0], "settings": parted(c)[1], "launches": launched[c]} for c in pick(CANDIDATES)],
              "views": [{**v, "noise": noise_of(charts, v)} for v in probed],
              "errors": list(map(pick, errors)), "ms": list(map(pick, ms)), "made_views": made[0], "made_errors": list(map(pick, made[1])),
              "sizes": [{**entry, "ms": pick(entry["ms"])} for entry in sizes(work, threads, beyond)], "ms_per_megatexel": per_megatexel(work), "maps": json.loads((work / "maps.json").read_text()), "rival": rivals(work, threads, beyond)}
    before = json.loads(DATA.read_text()) if DATA.exists() else {}
    if "rest" in before and [c["settings"] for c in before["candidates"]] == [c["settings"] for c in result["candidates"]]:
        result.update({key: before[key] for key in ("rest", "rest_shares")})  # planner_rest.py's
    DATA.write_text(compact(result), encoding="utf-8")
    print(DATA)


def seed_errors(files, index):
    """Errors of the sample sets in files in folders that are called by a set's number, by view and candidate. Of a point in two files the last counts."""
    result = {}
    for file in files:
        seed = int(re.search(r"\d+", file.parent.name).group())
        for p in read_points(file.parent)[1]:
            for c, candidate in enumerate(CANDIDATES):
                if is_point_of(p, candidate, seed) and (is_drawn(candidate) or seed == 0):
                    result.setdefault((index[pathlib.Path(p["scene"]).stem, p["camera"]], c), {})[seed] = noiseless(p["errors"]["all"])
    return result


def made_up(work):
    """Probes of made-up scenes, and errors of the candidates whose light they know."""
    probed = json.loads((work / "train_probes.json").read_text())
    known = seed_errors(sorted(work.glob("train[0-9]*/results.json")), {(v["scene"], v["camera"]): i for i, v in enumerate(probed)})
    of = lambda v, c: rounded(statistics.geometric_mean(known[v, c].values())) if (v, c) in known else None  # noqa: E731
    return probed, [[of(v, c) for c in range(len(CANDIDATES))] for v in range(len(probed))]


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


def share_times(ms):
    """Strict and careful look-ups of the same settings take as long (0.997, rows that did not change being 1): both have the time of the quicker sitting."""
    for c, candidate in enumerate(CANDIDATES):
        other = candidate.replace("visibility=careful", "visibility=strict")
        if other == candidate or other not in CANDIDATES:
            continue
        for row in ms:
            known = [t for t in (row[c], row[CANDIDATES.index(other)]) if t is not None]
            if known:
                row[c] = row[CANDIDATES.index(other)] = min(known)


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
    """Of all sample sets: the least times, as of the techniques, and geometric means of the errors."""
    sets = {}
    for file in sorted(work.glob("rival[0-9]*/results.json")):
        for p in read_points(file.parent)[1]:
            sets.setdefault((p["scene"], p["camera"], *(p["parameters"][key] for key in ("bounces", "spp", "resolution"))), []).append(p)
    return [{"scene": scene, "camera": camera, "bounces": bounces, "spp": spp, "resolution": resolution, "sets": len(of),
             "ms": rounded(min(time_of(p, threads) for p in of) * beyond),
             "all": rounded(statistics.geometric_mean(noiseless(p["errors"]["all"]) for p in of))}
            for (scene, camera, bounces, spp, resolution), of in sets.items()]


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
