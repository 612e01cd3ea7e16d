#!/usr/bin/env python3
"""Makes the tables of times in docs/techniques/ssvp.md: passes by number of clusters, as Table I of Aranha et al. 2020, and the
setting that has a budget, and frames that keep their light.

    docs/figures/ssvp.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--part passes budget kept]
                         [--size 1280x720] [--scenes cornell sibenik sponza_dabrovic sponza_crytek living_room level_zdm2]

Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. Frames are at rest, so that their maps are kept; what drawing
all maps takes is read from a first frame.
"""
import json
import os
import statistics

from program import ROOT, caller, read_options

CLUSTERS = [4, 8, 16, 32]
LARGE = "1920x1080"
# The budget is for the paper's setting, whose second bounce has no shadows.
BUDGET = ["shadowed_bounces=1", "clusters=8"]
VARIANTS = {"hard": [], "soft": ["visibility=soft"], "half": ["resolution=half"]}
RUNS = 3
SETTLING = 50  # frames until VPLs are kept: 16 for each of three bounces' clusters
KEPT = ["vpls=512 clusters=16 bounces=4 resolution=quarter", "vpls=1024 clusters=32 second_vpls=8 bounces=4 resolution=quarter",
        "vpls=1024 clusters=64 bounces=4 resolution=quarter", "vpls=1024 clusters=64 bounces=4 resolution=half"]
STRICT = "visibility=strict"
# Column: the passes that begin with one of these.
GROUPS = {"RSM, VPLs": ("rsm_input", "vpl_sampling"), "clusters": ("kmeans",), "second bounce, order": ("second_bounce", "clustered_gather.order"),
          "tiles": ("interleaved_gather.bounds", "interleaved_gather.cull"), "gather": ("clustered_gather.gather",),
          "filter": ("interleaved_gather.filter", "joint_bilateral")}
MAPS = ("paraboloid_map",)


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "level_zdm2"], 0, parts=["passes", "budget", "kept"])
    call = caller(options.lightwell)

    def render(scene, *settings, size=options.size, frames=1, warmup=0):
        sets = [part for setting in settings for part in ("--set", setting)]
        return json.loads(call("render", scene, "--technique", "ssvp", *sets, "--size", size, "--frames", frames, "--warmup", warmup,
                               "--out", options.work / "ssvp.exr", "--json"))

    page = ROOT / "docs/techniques/ssvp.md"
    for part, lines in (("passes", passes_table), ("budget", budget_table), ("kept", kept_table)):
        if part in options.part:
            replace(page, part, lines(options, render))
    print(page)


def passes_table(options, render):
    lines = [f"Milliseconds at {options.size}, defaults but for the clusters, device time of each pass, medians of 21 frames at rest; "
             f"load average {os.getloadavg()[0]:.1f}. *all maps*: what drawing every map takes, once, in a first frame.", "",
             "| scene | clusters | " + " | ".join(GROUPS) + " | whole frame | soft | half resolution | all maps |",
             "| --- | ---: | " + " | ".join(["---:"] * (len(GROUPS) + 4)) + " |"]
    for scene in options.scenes:
        for clusters in (f"clusters={count}" for count in CLUSTERS):
            rest = render(scene, clusters, frames=21, warmup=4)
            soft = render(scene, clusters, "visibility=soft", frames=21, warmup=4)
            half = render(scene, clusters, "resolution=half", frames=21, warmup=4)
            first = render(scene, clusters)
            cells = [f"{spent(rest, names):.2f}" for names in GROUPS.values()]
            cells += [f"**{rest['total_ms']:.1f}**", f"{soft['total_ms']:.1f}", f"{half['total_ms']:.1f}", f"{spent(first, MAPS):.1f}"]
            lines.append(f"| {scene} | {clusters.split('=')[1]} | " + " | ".join(cells) + " |")
    return lines


def budget_table(options, render):
    """The runs of a scene take turns, so that a slow minute falls on all of its cells."""
    columns = [(size, name, settings) for size in (options.size, LARGE) for name, settings in VARIANTS.items()]
    lines = [f"Milliseconds of a frame at rest with `{' '.join(BUDGET)}`, from the host's images to its output: median (least) of {RUNS} runs, each the "
             f"median of 15 frames after 5; load average {os.getloadavg()[0]:.1f}.", "",
             "| scene | " + " | ".join(f"{name}, {size}" for size, name, _ in columns) + " |", "| --- | " + " | ".join(["---:"] * len(columns)) + " |"]
    for scene in options.scenes:
        runs = [[render(scene, *BUDGET, *settings, size=size, frames=15, warmup=5)["total_ms"] for size, _, settings in columns] for _ in range(RUNS)]
        lines.append(f"| {scene} | " + " | ".join(f"{statistics.median(cell):.1f} ({min(cell):.1f})" for cell in zip(*runs)) + " |")
    return lines


def kept_table(options, render):
    """A host that tells no versions and one that does take turns, so that a slow minute falls on both."""
    lines = [f"Milliseconds at {options.size}, `{STRICT}`, versions not told → told, and the median of the runs' ratios: medians of {RUNS} runs, each the median of 15 frames after {SETTLING}; load "
             f"average {os.getloadavg()[0]:.1f}.", "",
             "| scene | " + " | ".join(f"`{row.replace('resolution=', '')}`" for row in KEPT) + " |", "| --- | " + " | ".join(["---:"] * len(KEPT)) + " |"]
    for scene in options.scenes:
        cells = []
        for row in KEPT:
            runs = [[render(scene, *row.split(), STRICT, f"rsm_versions={told}", frames=15, warmup=SETTLING)["total_ms"] for told in ("off", "on")] for _ in range(RUNS)]
            off, on = (statistics.median(some) for some in zip(*runs))
            cells.append(f"{off:.1f} → {on:.1f}, x {statistics.median(b / a for a, b in runs):.2f}")
        lines.append(f"| {scene} | " + " | ".join(cells) + " |")
    return lines


def replace(page, part, lines):
    """Puts the lines between the marks of a part."""
    begin, end = f"<!-- begin: {part} -->", f"<!-- end: {part} -->"
    before, rest = page.read_text(encoding="utf-8").split(begin)
    page.write_text(before + begin + "\n" + "\n".join(lines) + "\n" + end + rest.split(end)[1], encoding="utf-8")


def spent(report, names):
    return sum(p["ms"] for p in report["passes"] if p["name"].startswith(names))


if __name__ == "__main__":
    main()
