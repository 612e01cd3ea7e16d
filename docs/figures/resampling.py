#!/usr/bin/env python3
"""Writes the tables and the picture of docs/techniques/ssvp_resampling.md: the resampled gather of technique ssvp beside the interleaved one.

    docs/figures/resampling.py --lightwell PROGRAM [--work build/figures] [--part chart errors flicker page] [--truth-cache DIR]
                               [--scenes cornell rooms sponza_crytek living_room sibenik]

PROGRAM: of a version that has parameter `gather` (docs/techniques/ssvp_resampling.md names it); today's has not. Scenes other than
the shipped ones are looked for in LIGHTWELL_SCENES. What has been measured lies in --work and is kept: remove it to measure
anew. `chart` wants the machine for itself; errors do not mind other load.
"""
import json
import subprocess
import sys

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

from program import ROOT, caller, read_options, write_between

PAGE, IMAGE = ROOT / "docs/techniques/ssvp_resampling.md", ROOT / "docs/images/ssvp_resampling.svg"
CHART_SIZE, CHART_SCENES, CHART_LISTS = "1280x720", ["cornell", "sponza_crytek"], [(8, 256), (32, 256), (32, 1024)]
CHART_TRUTH = ["--cameras", "first", "--judge-one-of", 6, "--noise", "3e-3", "--picture-noise", "1e9", "--kept-truths"]
# Paths a pixel of the truths of small pictures.
SIZE, TRUTHS = "320x180", {"cornell": 512, "rooms": 512, "sponza_crytek": 128, "living_room": 512, "sibenik": 512}
KINDS = {"interleaved": (), "1 group": ("cluster_groups=1",), "16 groups": ("cluster_groups=16",),
         "8 / 2": ("gather=resampled", "candidates=8", "survivors=2"), "16 / 4": ("gather=resampled", "candidates=16", "survivors=4"),
         "64 / 8": ("gather=resampled", "candidates=64", "survivors=8")}
LISTS = [(8, 256), (8, 1024), (32, 256), (32, 1024), (32, 4096)]
SEQUENCES = ["camera_pan", "light_sweep_slow"]


def wanted(clusters, vpls, kind):
    return {"1 group": False, "16 groups": clusters == 32, "64 / 8": (clusters, vpls) == (32, 1024)}.get(kind, True)


def points():
    return [(clusters, vpls, kind) for clusters, vpls in LISTS for kind in KINDS if wanted(clusters, vpls, kind)]


def charted():
    return [(clusters, vpls, kind) for clusters, vpls in CHART_LISTS for kind in KINDS if kind != "64 / 8"]


def settings_of(clusters, vpls, kind):
    return [f"clusters={clusters}", f"vpls={vpls}", *KINDS[kind]]


def main():
    options = read_options(__doc__, list(TRUTHS), 0, parts=("chart", "errors", "flicker", "page"), more=("truth-cache",))
    call = caller(options.lightwell)
    if "chart" in options.part:
        measure_chart(options)
    if "errors" in options.part:
        measure_errors(options, call)
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
    return f"{SIZE}_{scene}_{clusters}_{vpls}_{kind}".replace(" ", "").replace("/", "of")


def technique_of(point, *more):
    return ",".join(["ssvp", *settings_of(*point), *more])


def run(*command):
    if subprocess.run([str(part) for part in command], check=False).returncode:
        sys.exit(f"lightwell {command[1]} failed")


def measure_chart(options):
    """Goes on where an earlier run has stopped."""
    cache = ["--truth-cache", options.truth_cache] if options.truth_cache else []
    run(options.lightwell, "chart", "--out", options.work / "resampling_chart", "--scenes", *CHART_SCENES, "--size", CHART_SIZE, *CHART_TRUTH, *cache,
        "--no-report", "--techniques", *map(technique_of, charted()))


def measure_errors(options, call):
    for scene in options.scenes:
        truth = options.work / f"truth_{SIZE}_{scene}.exr"

        def trace(scene=scene, truth=truth):
            said = call("reference", scene, "--bounces", 2, "--spp", TRUTHS[scene], "--size", SIZE, "--out", truth)
            return {"noise": float(said.split("noise (relMSE)")[1].split()[0])}
        kept(options, f"truth_{SIZE}_{scene}", trace)
        for point in points():
            def measure(scene=scene, point=point, truth=truth):
                exr = options.work / (name_of(scene, *point) + ".exr")
                sets = [part for setting in settings_of(*point) for part in ("--set", setting)]
                call("render", scene, "--technique", "ssvp", *sets, "--size", SIZE, "--frames", 1, "--warmup", 2, "--out", exr)
                return json.loads(call("compare", exr, truth, "--json"))
            kept(options, "error_" + name_of(scene, *point), measure)


def measure_flicker(options):
    folder = options.work / "resampling_stability"
    if (folder / "stability.json").exists():
        return
    techniques = [technique_of((32, 1024, kind), f"history={history}") for kind in ("interleaved", "16 groups", "16 / 4") for history in (0, 8)]
    run(options.lightwell, "stability", "--out", folder, "--no-report", "--size", SIZE, "--frames", 16, "--sequences", *SEQUENCES, "--techniques", *techniques)


def label(kind):
    return kind if "/" not in kind else "resampled " + kind


def chart_of(options):
    """(milliseconds of processor time, errors) by scene and point."""
    results = json.loads((options.work / "resampling_chart/results.json").read_text(encoding="utf-8"))
    found = {}
    for result in results["points"]:
        of = result["parameters"]
        for point in charted():
            defaults = {"clusters": 8, "vpls": 256, "cluster_groups": 4, "gather": "interleaved", "candidates": 16, "survivors": 4}
            wanted_values = {**defaults, **{k: type(defaults[k])(v) for k, v in (setting.split("=") for setting in settings_of(*point))}}
            if all(of[key] == value for key, value in wanted_values.items()):
                found[result["scene"], point] = (result["processor_ms"]["median"], result["errors"]["own"])
    return found


def write_page(options):
    chart = chart_of(options)
    write_between(PAGE, "<!-- begin: chart -->", "<!-- end: chart -->",
                  chart_table(chart) + ["", "![Error against time of both gathers](../images/ssvp_resampling.svg)"])
    write_between(PAGE, "<!-- begin: errors -->", "<!-- end: errors -->", error_table(options))
    stability = json.loads((options.work / "resampling_stability/stability.json").read_text(encoding="utf-8"))
    write_between(PAGE, "<!-- begin: flicker -->", "<!-- end: flicker -->", flicker_table(stability))
    plot(chart)


def chart_table(chart):
    noise = ", ".join(f"{chart[scene, charted()[0]][1]['noise']:.1g}" for scene in CHART_SCENES)
    lines = [f"`lightwell chart`, {CHART_SIZE}, first cameras, a pixel of each 6 x 6 against two bounces by path tracing (noise of the truths, relMSE: {noise}); milliseconds of "
             "processor time of a frame at rest, of all threads together, which other load lengthens little: on two cores twice the frame's. *Resampled*: candidates / survivors. Bold: less relMSE than all interleaved rows of the scene that take no longer.", "",
             "| clusters, VPLs, gather | " + " | ".join(f"{scene}: ms | relMSE | nRMSE" for scene in CHART_SCENES) + " |",
             "| --- | " + " | ".join(["---: | ---: | ---:"] * len(CHART_SCENES)) + " |"]
    wins = 0
    for point in charted():
        cells = []
        for scene in CHART_SCENES:
            ms, error = chart[scene, point]
            rivals = [chart[scene, p] for p in charted() if "/" not in p[2]]
            is_ahead = "/" in point[2] and all(error["relMSE"] < e["relMSE"] for t, e in rivals if t <= ms)
            wins += is_ahead
            mark = "**" if is_ahead else ""
            cells.append(f"{ms:.1f} | {mark}{error['relMSE']:.3f}{mark} | {error['nrmse']:.3f}")
        lines.append(f"| {point[0]}, {point[1]:,}, {label(point[2])} | " + " | ".join(cells) + " |")
    return lines + ["", f"{wins} of {sum('/' in p[2] for p in charted()) * len(CHART_SCENES)} resampled points are ahead."]


def error_table(options):
    noise = ", ".join(f"{kept(options, f'truth_{SIZE}_{scene}', dict)['noise']:.1g}" for scene in TRUTHS)
    lines = [f"relMSE / nRMSE at {SIZE} against two bounces by path tracing (noise of the truths: {noise}); one seed.", "",
             "| clusters, VPLs, gather | " + " | ".join(TRUTHS) + " |", "| --- | " + " | ".join(["---:"] * len(TRUTHS)) + " |"]
    for point in points():
        cells = []
        for scene in TRUTHS:
            error = json.loads((options.work / f"resampling_error_{name_of(scene, *point)}.json").read_text(encoding="utf-8"))
            cells.append(f"{error['relMSE']:.3f} / {error['nrmse']:.2f}")
        lines.append(f"| {point[0]}, {point[1]:,}, {label(point[2])} | " + " | ".join(cells) + " |")
    return lines


def flicker_table(data):
    lines = [f"`lightwell stability`, 16 frames of {SIZE}, 32 clusters, 1,024 VPLs.", "", "| sequence | gather | history | flicker (floor) | relMSE |",
             "| --- | --- | ---: | ---: | ---: |"]
    for result in data["results"]:
        of = result["parameters"]
        kind = "resampled 16 / 4" if of["gather"] == "resampled" else "16 groups" if of["cluster_groups"] == 16 else "interleaved"
        lines.append(f"| {result['sequence']} | {kind} | {of['history']} | {result['indices']['flicker']:.3f} ({result['floors']['flicker']:.3f}) | "
                     f"{result['errors']['relMSE']:.3f} |")
    return lines


def plot(chart):
    figure, axes = pyplot.subplots(1, len(CHART_SCENES), figsize=(3.6 * len(CHART_SCENES), 3.2))
    marks = {"interleaved": "o", "1 group": "x", "16 groups": "s", "8 / 2": "v", "16 / 4": "^"}
    for axis, scene in zip(axes, CHART_SCENES):
        for kind, mark in marks.items():
            found = [chart[scene, p] for p in charted() if p[2] == kind]
            axis.semilogy([ms for ms, _ in found], [error["relMSE"] for _, error in found], mark, color="tab:blue" if "/" not in kind else "tab:red",
                        label=label(kind))
        axis.set_title(scene)
        axis.set_xlabel("processor ms")
    axes[0].set_ylabel("relMSE")
    axes[0].legend(fontsize=6)
    figure.tight_layout()
    matplotlib.rcParams["svg.hashsalt"] = "lightwell"
    figure.savefig(IMAGE, metadata={"Date": None})


if __name__ == "__main__":
    main()
