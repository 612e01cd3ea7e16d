#!/usr/bin/env python3
"""Writes the tables of docs/techniques/vpl_view_sampling.md: VPLs of technique ssvp drawn by flux and chosen for the view.

    docs/figures/view_sampling.py --lightwell PROGRAM [--work build/figures] [--part chart time flicker page] [--truth-cache DIR]
                                  [--scenes level_zdm2 sponza_crytek ...]

Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. What has been measured lies in --work and is kept: remove it to
measure anew. `time` wants the machine for itself; errors do not mind other load.
"""
import json
import math
import subprocess
import sys

from program import ROOT, caller, read_options, write_between

PAGE = ROOT / "docs/techniques/vpl_view_sampling.md"
SCENES = ["cornell", "basic", "rooms", "cornell_original", "sponza_crytek", "sponza_dabrovic", "sibenik", "living_room", "wooden_staircase",
          "breakfast_room", "level_zdm2", "bunny_corner"]
# VPLs, clusters, bounces.
LISTS = [(256, 8, 2), (512, 16, 2), (1024, 64, 2), (1024, 64, 4)]
SEEDS = [1, 2, 3]
SAMPLINGS = ["flux", "view"]
TRUTH = ["--cameras", "first", "--size", "1280x720", "--judge-one-of", 10, "--picture-noise", 0, "--kept-truths"]


def main():
    options = read_options(__doc__, SCENES, 0, parts=("chart", "time", "flicker", "page"), more=("truth-cache",))
    if "chart" in options.part:
        measure(options)
    if "time" in options.part:
        measure_time(options, caller(options.lightwell))
    if "flicker" in options.part:
        measure_flicker(options)
    if "page" in options.part:
        write_page(options)


def measure(options):
    """Goes on where an earlier run has stopped."""
    cache = ["--truth-cache", options.truth_cache] if options.truth_cache else []
    techniques = [f"ssvp,vpls={v},clusters={c},bounces={b},resolution=half,seed={seed},sampling={s}"
                  for s in SAMPLINGS for v, c, b in LISTS for seed in SEEDS]
    command = [options.lightwell, "chart", "--out", options.work / "view_sampling", "--scenes", *options.scenes, "--frames", 2, *TRUTH, *cache,
               "--no-report", "--techniques", *techniques]
    if subprocess.run([str(part) for part in command], check=False).returncode:
        sys.exit("lightwell chart failed")


def measure_time(options, call):
    for sampling in SAMPLINGS:
        path = options.work / f"view_sampling_time_{sampling}.json"
        if not path.exists():
            sets = [f"sampling={sampling}", "vpls=1024", "clusters=64", "bounces=2", "resolution=half"]
            path.write_text(call("render", "sponza_crytek", "--size", "1280x720", "--frames", 20, "--technique", "ssvp", "--set", *sets, "--out",
                                 options.work / "view_sampling.exr", "--json"), encoding="utf-8")


def measure_flicker(options):
    folder = options.work / "view_sampling_stability"
    if (folder / "stability.json").exists():
        return
    cache = ["--truth-cache", options.truth_cache] if options.truth_cache else []
    techniques = [f"ssvp,vpls=1024,clusters=64,resolution=half,sampling={s}" for s in SAMPLINGS]
    command = [options.lightwell, "stability", "--out", folder, "--scenes", "sponza_crytek", "--frames", 6, "--size", "160x90", "--sequences", "camera_dolly",
               "--truth-effort", 0.1, *cache, "--no-report", "--techniques", *techniques]
    if subprocess.run([str(part) for part in command], check=False).returncode:
        sys.exit("lightwell stability failed")


def time_lines(options):
    total, passes = {}, {}
    for sampling in SAMPLINGS:
        of = json.loads((options.work / f"view_sampling_time_{sampling}.json").read_text(encoding="utf-8"))
        total[sampling] = of["total_ms"]
        passes[sampling] = {p["name"]: p["ms"] for p in of["passes"] if p["name"].startswith(("vpl_sampling", "vpl_view_sampling"))}
    more = sum(passes["view"].values()) - sum(passes["flux"].values())
    drawing = passes["view"]["vpl_sampling.draw"] - passes["flux"]["vpl_sampling.draw"]
    return [f"Crytek Sponza, 1,024 VPLs, two cores, 1280x720: {more:.2f} ms more than by flux in the passes of the list ({drawing:.2f} of them for drawing candidates, "
            f"{passes['view']['vpl_view_sampling.weigh']:.2f} for weighing). The gather takes longer too, since tiles skip fewer VPLs that light something: the whole frame of "
            f"64 clusters and two bounces at half resolution takes {total['view']:.1f} ms for {total['flux']:.1f}."]


def flicker_lines(options):
    results = json.loads((options.work / "view_sampling_stability/stability.json").read_text(encoding="utf-8"))["results"]
    of = {result["parameters"]["sampling"]: result["indices"] for result in results}
    cells = ", ".join(f"{name} {of['flux'][name]:.2g} → {of['view'][name]:.2g}" for name in ("flicker", "drift", "spike"))
    return [f"`lightwell stability`, Crytek Sponza, `camera_dolly`, six frames of 160x90, 1,024 VPLs, 64 clusters, by flux → by view: {cells}."]


def mean(values):
    return math.exp(sum(math.log(value) for value in values) / len(values))


def write_page(options):
    found = {}
    for result in json.loads((options.work / "view_sampling/results.json").read_text(encoding="utf-8"))["points"]:
        of, errors = result["parameters"], result["errors"]["all"]
        key = (result["scene"], (of["vpls"], of["clusters"], of["bounces"]), of["sampling"])
        found.setdefault(key, []).append((errors["relMSE"], errors["nrmse"], errors["bias"]))
    whole = len(SAMPLINGS) * len(LISTS) * len(SEEDS)
    scenes = [scene for scene in SCENES if sum(len(found[key]) for key in found if key[0] == scene) == whole]
    rows = {}
    for scene in scenes:
        for of in LISTS:
            for sampling in SAMPLINGS:
                values = found[scene, of, sampling]
                rows[scene, of, sampling] = (mean([v[0] for v in values]), mean([v[1] for v in values]), sum(v[2] for v in values) / len(values))
    head = [f"`lightwell chart`, 1280x720, half resolution, first cameras, {len(SEEDS)} seeds (geometric means), against the light of all bounces. Each cell: by flux → by view.", ""]
    write_between(PAGE, "<!-- begin: means -->", "<!-- end: means -->", head + mean_table(scenes, rows))
    write_between(PAGE, "<!-- begin: time -->", "<!-- end: time -->", time_lines(options))
    write_between(PAGE, "<!-- begin: flicker -->", "<!-- end: flicker -->", flicker_lines(options))
    write_between(PAGE, "<!-- begin: scenes -->", "<!-- end: scenes -->", scene_table(scenes, rows))


def mean_table(scenes, rows):
    lines = ["| VPLs, clusters, bounces | relMSE | nRMSE | scenes with less nRMSE |", "| --- | --- | --- | ---: |"]
    for of in LISTS:
        each = {s: [mean([rows[scene, of, s][i] for scene in scenes]) for i in (0, 1)] for s in SAMPLINGS}
        better = sum(rows[scene, of, "view"][1] < rows[scene, of, "flux"][1] for scene in scenes)
        lines.append(f"| {of[0]:,}, {of[1]}, {of[2]} | {each['flux'][0]:.3f} → {each['view'][0]:.3f} | {each['flux'][1]:.3f} → {each['view'][1]:.3f} "
                     f"| {better} of {len(scenes)} |")
    return lines


def scene_table(scenes, rows):
    shown = LISTS[0], LISTS[2]
    lines = ["| scene | " + " | ".join(f"{v:,}, {c}, {b}: relMSE | nRMSE | bias" for v, c, b in shown) + " |",
             "| --- | " + " | ".join(["---", "---", "---"] * len(shown)) + " |"]
    for scene in scenes:
        cells = []
        for of in shown:
            flux, view = rows[scene, of, "flux"], rows[scene, of, "view"]
            cells += [f"{flux[0]:.3f} → {view[0]:.3f}", f"{flux[1]:.3f} → {view[1]:.3f}", f"{flux[2]:+.0%} → {view[2]:+.0%}".replace("%", " %")]
        lines.append(f"| {scene} | " + " | ".join(cells) + " |")
    return lines


if __name__ == "__main__":
    main()
