#!/usr/bin/env python3
"""Makes the table of times in docs/techniques/ssvp.md: passes by number of clusters, as Table I of Aranha et al. 2020.

    docs/figures/ssvp.py [--lightwell build/release/bin/lightwell] [--work build/figures]
                         [--size 1280x720] [--scenes cornell sibenik sponza_crytek living_room]

Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. Frames are at rest, so that their maps are kept; what drawing
all maps takes is read from a first frame.
"""
import json
import os

from program import ROOT, caller, read_options

CLUSTERS = [4, 8, 16, 32]
BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
# Column: the passes that begin with one of these.
GROUPS = {"RSM, VPLs": ("rsm_input", "vpl_sampling"), "clusters": ("kmeans",), "second bounce, order": ("second_bounce", "clustered_gather.order"),
          "tiles": ("interleaved_gather.bounds", "interleaved_gather.cull"), "gather": ("clustered_gather.gather",),
          "filter": ("interleaved_gather.filter", "joint_bilateral")}
MAPS = ("paraboloid_map",)


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_crytek", "living_room"], 0)
    call = caller(options.lightwell)

    def render(scene, clusters, *settings, frames=1, warmup=0):
        sets = [part for setting in (f"clusters={clusters}", *settings) for part in ("--set", setting)]
        return json.loads(call("render", scene, "--technique", "ssvp", *sets, "--size", options.size, "--frames", frames, "--warmup", warmup,
                               "--out", options.work / "ssvp.exr", "--json"))

    lines = [f"Milliseconds at {options.size}, defaults but for the clusters, device time of each pass, medians of 21 frames at rest; "
             f"load average {os.getloadavg()[0]:.1f}. *all maps*: what drawing every map takes, once, in a first frame.", "",
             "| scene | clusters | " + " | ".join(GROUPS) + " | whole frame | soft | half resolution | all maps |",
             "| --- | ---: | " + " | ".join(["---:"] * (len(GROUPS) + 4)) + " |"]
    for scene in options.scenes:
        for clusters in CLUSTERS:
            rest = render(scene, clusters, frames=21, warmup=4)
            soft = render(scene, clusters, "visibility=soft", frames=21, warmup=4)
            half = render(scene, clusters, "resolution=half", frames=21, warmup=4)
            first = render(scene, clusters)
            cells = [f"{spent(rest, names):.2f}" for names in GROUPS.values()]
            cells += [f"**{rest['total_ms']:.1f}**", f"{soft['total_ms']:.1f}", f"{half['total_ms']:.1f}", f"{spent(first, MAPS):.1f}"]
            lines.append(f"| {scene} | {clusters} | " + " | ".join(cells) + " |")
    page = ROOT / "docs/techniques/ssvp.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(page)


def spent(report, names):
    return sum(p["ms"] for p in report["passes"] if p["name"].startswith(names))


if __name__ == "__main__":
    main()
