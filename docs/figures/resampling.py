#!/usr/bin/env python3
"""Writes the tables and the picture of docs/techniques/ssvp_resampling.md: the resampled gather of technique ssvp beside the interleaved one.

    docs/figures/resampling.py --lightwell PROGRAM [--work build/figures] [--part errors times flicker page]
                               [--size 320x180] [--scenes cornell rooms sponza_crytek living_room sibenik] [--spp 512]

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
TIME_SIZE = "1280x720"
KINDS = {"interleaved": (), "16 groups": ("cluster_groups=16",),
         "8 / 2": ("gather=resampled", "candidates=8", "survivors=2"), "16 / 4": ("gather=resampled", "candidates=16", "survivors=4"),
         "64 / 8": ("gather=resampled", "candidates=64", "survivors=8")}
LISTS = [(8, 256), (8, 1024), (32, 256), (32, 1024), (32, 4096)]
SEQUENCES, FLICKER_SIZE = ["camera_pan", "light_sweep_slow"], "320x180"


def wanted(clusters, vpls, kind):
    return {"16 groups": clusters == 32, "64 / 8": (clusters, vpls) == (32, 1024)}.get(kind, True)


def points():
    return [(clusters, vpls, kind) for clusters, vpls in LISTS for kind in KINDS if wanted(clusters, vpls, kind)]


def settings_of(clusters, vpls, kind):
    return [f"clusters={clusters}", f"vpls={vpls}", *KINDS[kind]]


def main():
    options = read_options(__doc__, ["cornell", "rooms", "sponza_crytek", "living_room", "sibenik"], 512, "320x180",
                           ("errors", "times", "flicker", "page"))
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


def name_of(scene, clusters, vpls, kind):
    return f"{scene}_{clusters}_{vpls}_{kind}".replace(" ", "").replace("/", "of")


def render(call, scene, size, settings, frames, *more):
    sets = [part for setting in settings for part in ("--set", setting)]
    return json.loads(call("render", scene, "--technique", "ssvp", *sets, "--size", size, "--frames", frames, "--json", *more))


def measure_errors(options, call):
    for scene in options.scenes:
        truth = options.work / f"truth_{scene}.exr"
        if not truth.exists():
            call("reference", scene, "--bounces", 2, "--spp", options.spp, "--size", options.size, "--out", truth)
        for point in points():
            def measure(scene=scene, point=point, truth=truth):
                exr = options.work / (name_of(scene, *point) + ".exr")
                render(call, scene, options.size, settings_of(*point), 1, "--warmup", 2, "--out", exr)
                return json.loads(call("compare", exr, truth, "--json"))
            kept(options, "error_" + name_of(scene, *point), measure)


def measure_times(options, call):
    for scene in options.scenes:
        for point in points():
            def measure(scene=scene, point=point):
                found = render(call, scene, TIME_SIZE, settings_of(*point), 9, "--warmup", 2)
                return {"total_ms": found["total_ms"], "passes": found["passes"], "load_average": os.getloadavg()[0]}
            kept(options, "time_" + name_of(scene, *point), measure)


def measure_flicker(options):
    folder = options.work / "resampling_stability"
    if (folder / "stability.json").exists():
        return
    techniques = [f"ssvp,clusters=32,vpls=1024,history={history}" + "".join("," + s for s in KINDS[kind])
                  for kind in ("interleaved", "16 groups", "16 / 4") for history in (0, 8)]
    command = [options.lightwell, "stability", "--out", str(folder), "--no-report", "--size", FLICKER_SIZE, "--frames", "16", "--sequences", *SEQUENCES,
               "--techniques", *techniques]
    if subprocess.run(command, check=False).returncode:
        sys.exit("lightwell stability failed")


def read(options, what, scene, point):
    path = options.work / f"resampling_{what}_{name_of(scene, *point)}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def write_page(options):
    lines = [f"relMSE at {options.size} against path tracing of two bounces; milliseconds of a whole frame at {TIME_SIZE}, device time, medians of 9 frames. "
             "*Resampled*: candidates / survivors. Bold: less error than every interleaved row of the scene that takes no longer.", "",
             "| clusters, VPLs, gather | " + " | ".join(f"{scene} | ms" for scene in options.scenes) + " |",
             "| --- | " + " | ".join(["---: | ---:"] * len(options.scenes)) + " |"]
    fronts = {scene: [(read(options, "time", scene, p)["total_ms"], read(options, "error", scene, p)["relMSE"])
                      for p in points() if p[2] in ("interleaved", "16 groups")] for scene in options.scenes}
    wins = 0
    for point in points():
        clusters, vpls, kind = point
        cells = []
        for scene in options.scenes:
            error, time = read(options, "error", scene, point)["relMSE"], read(options, "time", scene, point)["total_ms"]
            is_ahead = "/" in kind and all(error < e for t, e in fronts[scene] if t <= time)
            wins += is_ahead
            cells.append((f"**{error:.3f}**" if is_ahead else f"{error:.3f}") + f" | {time:.1f}")
        label = kind if "/" not in kind else f"resampled {kind}"
        lines.append(f"| {clusters}, {vpls:,}, {label} | " + " | ".join(cells) + " |")
    count = sum("/" in p[2] for p in points()) * len(options.scenes)
    lines += ["", f"{wins} of {count} resampled points are ahead of the interleaved ones.", "",
              "![Error against time of both gathers](../images/ssvp_resampling.svg)"]
    write_between(PAGE, "<!-- begin: chart -->", "<!-- end: chart -->", lines)
    write_between(PAGE, "<!-- begin: passes -->", "<!-- end: passes -->", pass_table(options))
    folder = options.work / "resampling_stability"
    if (folder / "stability.json").exists():
        write_between(PAGE, "<!-- begin: flicker -->", "<!-- end: flicker -->", flicker_table(json.loads((folder / "stability.json").read_text(encoding="utf-8"))))
    plot(options)


def pass_table(options):
    lines = ["Milliseconds of passes as above, 32 clusters: *draw* is `vpl_resampling.blocks`, `.bounds`, `.weigh` and `.draw`; of the interleaved gather the tiles' "
             "`bounds` and `cull`.", "", "| VPLs, gather | " + " | ".join(f"{scene}: draw | gather" for scene in options.scenes) + " |",
             "| --- | " + " | ".join(["---: | ---:"] * len(options.scenes)) + " |"]
    for point in points():
        if point[0] != 32:
            continue
        cells = []
        for scene in options.scenes:
            passes = {p["name"]: p["ms"] for p in read(options, "time", scene, point)["passes"]}
            gather = passes.get("vpl_resampling.gather", 0) + passes.get("clustered_gather.gather", 0)
            draw = sum(ms for name, ms in passes.items() if name.startswith(("vpl_resampling.", "interleaved_gather.bounds", "interleaved_gather.cull")))
            cells.append(f"{draw - passes.get('vpl_resampling.gather', 0):.1f} | {gather:.1f}")
        lines.append(f"| {point[1]:,}, {point[2]} | " + " | ".join(cells) + " |")
    return lines


def flicker_table(data):
    lines = ["| sequence | technique | flicker | spike | relMSE |", "| --- | --- | ---: | ---: | ---: |"]
    for result in data["results"]:
        lines.append(f"| {result['sequence']} | {result['technique']} | " + " | ".join(
            f"{result['indices'][key]:.4f}" if result["indices"].get(key) is not None else "" for key in ("flicker", "spike", "relMSE")) + " |")
    return lines


def plot(options):
    figure, axes = pyplot.subplots(1, len(options.scenes), figsize=(3 * len(options.scenes), 3.2), squeeze=False)
    marks = {"interleaved": "o", "16 groups": "s", "8 / 2": "v", "16 / 4": "^", "64 / 8": "D"}
    for axis, scene in zip(axes[0], options.scenes):
        for kind, mark in marks.items():
            own = [p for p in points() if p[2] == kind]
            axis.loglog([read(options, "time", scene, p)["total_ms"] for p in own], [read(options, "error", scene, p)["relMSE"] for p in own], mark,
                        color="tab:blue" if "/" not in kind else "tab:red", fillstyle="full" if kind in ("interleaved", "16 / 4") else "none",
                        label=kind if "/" not in kind else f"resampled {kind}")
        axis.set_title(scene)
        axis.set_xlabel("ms")
    axes[0][0].set_ylabel("relMSE")
    axes[0][0].legend(fontsize=6)
    figure.tight_layout()
    matplotlib.rcParams["svg.hashsalt"] = "lightwell"
    figure.savefig(IMAGE, metadata={"Date": None})


if __name__ == "__main__":
    main()
