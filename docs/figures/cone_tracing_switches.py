#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/cone_tracing_switches.md: cures of leaks and self-illumination, one by one, and what else
cones can be told, against one bounce of light.

    docs/figures/cone_tracing_switches.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 480x270] [--spp 64]

Needs numpy. Pictures and truths stay in --work: remove switches_* to measure anew.
"""
import json

from program import ROOT, caller, read_options, write_between

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
SCENES = ["cornell", "rooms", "sponza_crytek", "living_room"]
PLAIN = ["normal_aware=off"]
SWITCHES = {"none": PLAIN, "directional opacity": [*PLAIN, "directional_opacity=on"], "aperture offset": [*PLAIN, "aperture_offset=on"],
            "normal-aware": [], "two-sided": ["normal_aware=two_sided"], "normal-aware, aperture offset": ["aperture_offset=on"]}
OTHERS = {"nudge 0.5": ["nudge=0.5"], "nudge 1": [], "nudge 2": ["nudge=2"], "step 0.5": ["step=0.5"], "full resolution": ["resolution=full"],
          "64 cones": ["cones=64"], "64 cones, two-sided": ["cones=64", "normal_aware=two_sided"]}


def main():
    options = read_options(__doc__, SCENES, 64, "480x270")
    call = caller(options.lightwell)
    lines = []
    for size in (64, 128):
        lines += table(options, call, size, {**SWITCHES, **(OTHERS if size == 64 else {})})
    write_between(ROOT / "docs/techniques/cone_tracing_switches.md", BEGIN, END, lines)


def table(options, call, size, variants):
    lines = [f"`size={size}`:", "", "| | " + " | ".join(f"{s}: relMSE | bias" for s in options.scenes) + " |",
             "| --- | " + " | ".join(["---:"] * 2 * len(options.scenes)) + " |"]
    for name, settings in variants.items():
        cells = []
        for scene in options.scenes:
            found = measured(options, call, scene, [f"size={size}", *settings])
            cells.append(f"{found['relMSE']:.3g} | {100 * found['bias']:+.0f} %")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines + [""]


def measured(options, call, scene, settings):
    truth = options.work / f"switches_{scene}_truth.exr"
    if not truth.exists():
        call("reference", scene, "--bounces", 1, "--spp", options.spp, "--size", options.size, "--compact", "--out", truth)
    picture = options.work / ("_".join(["switches", scene, *settings]).replace("=", "") + ".exr")
    kept = picture.with_suffix(".json")
    if not picture.exists():
        call("render", scene, "--technique", "cone_tracing", "--size", options.size, "--warmup", 1, "--frames", 1,
             *(part for s in settings for part in ("--set", s)), "--out", picture)
    if not kept.exists():
        kept.write_text(call("compare", picture, truth, "--json"))
    return json.loads(kept.read_text())


if __name__ == "__main__":
    main()
