#!/usr/bin/env python3
"""Writes the tables and the picture of docs/techniques/ssvp_resampling.md: the resampled gather of technique ssvp beside the interleaved one.

    docs/figures/resampling.py --lightwell PROGRAM [--work build/figures] [--part errors times flicker page]
                               [--scenes cornell rooms sponza_crytek living_room sibenik]

PROGRAM: of a version that has parameter `gather` (docs/techniques/ssvp_resampling.md names it); today's has not. Scenes other than
the shipped ones are looked for in LIGHTWELL_SCENES. What has been measured lies in --work and is kept: remove it to measure
anew. Errors do not mind other load; `times` wants the machine for itself.
"""
import json
import os
import subprocess
import sys

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

from program import ROOT, caller, read_options, write_between

PAGE, IMAGE = ROOT / "docs/techniques/ssvp_resampling.md", ROOT / "docs/images/ssvp_resampling.svg"
# Paths a pixel of the truths, by size and scene.
TRUTHS = {"320x180": {"cornell": 512, "rooms": 512, "sponza_crytek": 128, "living_room": 512, "sibenik": 512},
          "1280x720": {"cornell": 64, "rooms": 64}}
KINDS = {"interleaved": (), "16 groups": ("cluster_groups=16",),
         "8 / 2": ("gather=resampled", "candidates=8", "survivors=2"), "16 / 4": ("gather=resampled", "candidates=16", "survivors=4"),
         "64 / 8": ("gather=resampled", "candidates=64", "survivors=8")}
LISTS = [(8, 256), (8, 1024), (32, 256), (32, 1024), (32, 4096)]
SEQUENCES = ["camera_pan", "light_sweep_slow"]


def wanted(clusters, vpls, kind):
    return {"16 groups": clusters == 32, "64 / 8": (clusters, vpls) == (32, 1024)}.get(kind, True)


def points():
    return [(clusters, vpls, kind) for clusters, vpls in LISTS for kind in KINDS if wanted(clusters, vpls, kind)]


def settings_of(clusters, vpls, kind):
    return [f"clusters={clusters}", f"vpls={vpls}", *KINDS[kind]]


def main():
    options = read_options(__doc__, list(TRUTHS["320x180"]), 0, parts=("errors", "times", "flicker", "page"))
    call = caller(options.lightwell)
    if "errors" in options.part:
        measure_errors(options, call)
    if "times" in options.part:
        measure_times(options, call)
    if "flicker" in options.part:
        measure_flicker(options)
    if "page" in options.part:
        write_page(options)


def kept(options, name, measure):
    """What `measure` returns; read back where it has been measured before."""
    path = options.work / f"resampling_{name}.json"
    if not path.exists():
        path.write_text(json.dumps(measure()), encoding="utf-8")
    return json.loads(path.read_text(encoding="utf-8"))


def pictures(options):
    """Size, scene and point of all that is measured."""
    return [(size, scene, *point) for size, scenes in TRUTHS.items() for scene in scenes if scene in options.scenes for point in points()]


def name_of(size, scene, clusters, vpls, kind):
    return f"{size}_{scene}_{clusters}_{vpls}_{kind}".replace(" ", "").replace("/", "of")


def render(call, size, scene, point, frames, *more):
    sets = [part for setting in settings_of(*point) for part in ("--set", setting)]
    return json.loads(call("render", scene, "--technique", "ssvp", *sets, "--size", size, "--frames", frames, "--warmup", 2, "--json", *more))


def measure_errors(options, call):
    for size, scene, *point in pictures(options):
        name, truth = name_of(size, scene, *point), options.work / f"truth_{size}_{scene}.exr"

        def trace(size=size, scene=scene, truth=truth):
            said = call("reference", scene, "--bounces", 2, "--spp", TRUTHS[size][scene], "--size", size, "--out", truth)
            return {"noise": float(said.split("noise (relMSE)")[1].split()[0])}

        def measure(size=size, scene=scene, point=point, name=name, truth=truth):
            exr = options.work / (name + ".exr")
            render(call, size, scene, point, 1, "--out", exr)
            return json.loads(call("compare", exr, truth, "--json"))
        kept(options, f"truth_{size}_{scene}", trace)
        kept(options, "error_" + name, measure)


def measure_times(options, call):
    for size, scene, *point in pictures(options):
        def measure(size=size, scene=scene, point=point):
            found = render(call, size, scene, point, 9)
            return {"total_ms": found["total_ms"], "passes": found["passes"], "load_average": os.getloadavg()[0]}
        kept(options, "time_" + name_of(size, scene, *point), measure)


def measure_flicker(options):
    folder = options.work / "resampling_stability"
    if (folder / "stability.json").exists():
        return
    techniques = [f"ssvp,clusters=32,vpls=1024,history={history}" + "".join("," + s for s in KINDS[kind])
                  for kind in ("interleaved", "16 groups", "16 / 4") for history in (0, 8)]
    command = [options.lightwell, "stability", "--out", str(folder), "--no-report", "--frames", "16", "--sequences", *SEQUENCES,
               "--techniques", *techniques]
    if subprocess.run(command, check=False).returncode:
        sys.exit("lightwell stability failed")


def read(options, what, *point):
    return json.loads((options.work / f"resampling_{what}_{name_of(*point)}.json").read_text(encoding="utf-8"))


def place(options, size, scene, point):
    """Milliseconds and relMSE."""
    return read(options, "time", size, scene, *point)["total_ms"], read(options, "error", size, scene, *point)["relMSE"]


def write_page(options):
    lines = []
    for size in TRUTHS:
        lines += chart_table(options, size)
    lines += ["![Error against time of both gathers](../images/ssvp_resampling.svg)"]
    write_between(PAGE, "<!-- begin: chart -->", "<!-- end: chart -->", lines)
    write_between(PAGE, "<!-- begin: passes -->", "<!-- end: passes -->", pass_table(options))
    stability = options.work / "resampling_stability/stability.json"
    if stability.exists():
        write_between(PAGE, "<!-- begin: flicker -->", "<!-- end: flicker -->", flicker_table(json.loads(stability.read_text(encoding="utf-8"))))
    plot(options)


def chart_table(options, size):
    noise = ", ".join(f"{kept(options, f'truth_{size}_{scene}', dict)['noise']:.1g}" for scene in TRUTHS[size])
    lines = [f"**{size}**: relMSE against two bounces by path tracing (noise {noise}) | milliseconds of a frame at rest, device time, median of 9. *Resampled*: "
             "candidates / survivors. Bold: less error than all interleaved rows of the scene that take no longer.", "",
             "| clusters, VPLs, gather | " + " | ".join(f"{scene} | ms" for scene in TRUTHS[size]) + " |",
             "| --- | " + " | ".join(["---: | ---:"] * len(TRUTHS[size])) + " |"]
    wins = 0
    for point in points():
        clusters, vpls, kind = point
        cells = []
        for scene in TRUTHS[size]:
            time, error = place(options, size, scene, point)
            rivals = [place(options, size, scene, p) for p in points() if "/" not in p[2]]
            is_ahead = "/" in kind and all(error < e for t, e in rivals if t <= time)
            wins += is_ahead
            cells.append((f"**{error:.3f}**" if is_ahead else f"{error:.3f}") + f" | {time:.1f}")
        lines.append(f"| {clusters}, {vpls:,}, {kind if '/' not in kind else 'resampled ' + kind} | " + " | ".join(cells) + " |")
    count = sum("/" in p[2] for p in points()) * len(TRUTHS[size])
    return lines + ["", f"{wins} of {count} resampled points are ahead.", ""]


def pass_table(options):
    shown = [(size, scene) for size in TRUTHS for scene in TRUTHS[size] if size == "1280x720"]
    lines = ["Milliseconds at 1280x720 with 32 clusters. *Draw*: `vpl_resampling.blocks`, `.bounds`, `.weigh` and `.draw`; of the interleaved gather the tiles' "
             "`bounds` and `cull`.", "", "| VPLs, gather | " + " | ".join(f"{scene}: draw | gather" for _, scene in shown) + " |",
             "| --- | " + " | ".join(["---: | ---:"] * len(shown)) + " |"]
    for point in points():
        if point[0] != 32:
            continue
        cells = []
        for size, scene in shown:
            passes = {p["name"]: p["ms"] for p in read(options, "time", size, scene, *point)["passes"]}
            gather = passes.get("vpl_resampling.gather", 0) + passes.get("clustered_gather.gather", 0)
            draw = sum(ms for name, ms in passes.items() if name.startswith(("vpl_resampling.", "interleaved_gather.bounds", "interleaved_gather.cull")))
            cells.append(f"{draw - passes.get('vpl_resampling.gather', 0):.1f} | {gather:.1f}")
        lines.append(f"| {point[1]:,}, {point[2] if '/' not in point[2] else 'resampled ' + point[2]} | " + " | ".join(cells) + " |")
    return lines


def flicker_table(data):
    lines = ["| sequence | technique | flicker | spike | relMSE |", "| --- | --- | ---: | ---: | ---: |"]
    for result in data["results"]:
        lines.append(f"| {result['sequence']} | {result['technique']} | " + " | ".join(
            f"{result['indices'][key]:.4f}" if result["indices"].get(key) is not None else "" for key in ("flicker", "spike", "relMSE")) + " |")
    return lines


def plot(options):
    shown = [(size, scene) for size in TRUTHS for scene in TRUTHS[size]]
    figure, axes = pyplot.subplots(1, len(shown), figsize=(2.4 * len(shown), 2.8), squeeze=False)
    marks = {"interleaved": "o", "16 groups": "s", "8 / 2": "v", "16 / 4": "^", "64 / 8": "D"}
    for axis, (size, scene) in zip(axes[0], shown):
        for kind, mark in marks.items():
            found = [place(options, size, scene, p) for p in points() if p[2] == kind]
            axis.loglog(*zip(*found), mark, color="tab:blue" if "/" not in kind else "tab:red",
                        fillstyle="full" if kind in ("interleaved", "16 / 4") else "none", label=kind if "/" not in kind else f"resampled {kind}")
        axis.set_title(f"{scene}\n{size}", fontsize=8)
        axis.set_xlabel("ms")
    axes[0][0].set_ylabel("relMSE")
    axes[0][0].legend(fontsize=6)
    figure.tight_layout()
    matplotlib.rcParams["svg.hashsalt"] = "lightwell"
    figure.savefig(IMAGE, metadata={"Date": None})


if __name__ == "__main__":
    main()
