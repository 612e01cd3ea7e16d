#!/usr/bin/env python3
"""Makes the figures of docs/techniques/horizon.md and ao.md: error against the one-bounce truth, time, pictures.

    docs/figures/horizon.py [--lightwell build/release/bin/lightwell] [--work build/figures]
                            [--size 640x360] [--scenes sponza_crytek sibenik] [--spp 32]

Writes docs/techniques/horizon_figures.md and docs/images/horizon_SCENE.png. Images, truths and times stay in --work and are
made again only when missing. Times are those of TIMED_SCENE at 1280x720, medians over frames; they want a quiet machine.
"""
import json

from program import ROOT, caller, read_options

TIMED_SCENE, TIMED_SIZE = "cornell", "1280x720"
LIMIT = "directions=40 steps=8 interleave=1"  # not timed: seconds a frame
SETTINGS = [("horizon", "defaults"), ("horizon", "directions=8"), ("horizon", "steps=1"), ("horizon", "directions=8 interleave=4"),
            ("horizon", "interleave=16"), ("horizon", "directions=24"), ("horizon", "steps=4"), ("horizon", "resolution=full"),
            ("horizon", LIMIT),
            ("ao", "defaults"), ("ao", "radius=1 packing=off"), ("ao", "samples=64"), ("ao", "samples=64 radius=1")]
PASSES = ["mip_pyramid.base", "mip_pyramid.reduce", "horizon_gather.gather", "point_occlusion.gather", "weighted_filter.columns",
          "weighted_filter.filter", "joint_bilateral.upsample"]


def main():
    options = read_options(__doc__, ["sponza_crytek", "sibenik"], 32, size="640x360")
    work, call = options.work, caller(options.lightwell)

    def render(scene, technique, setting, size, frames, warmup):
        name = f"{scene}_{technique}_{setting}_{size}".replace(" ", "_").replace("=", "")
        exr, report = work / f"{name}.exr", work / f"{name}.json"
        if not (exr.exists() and report.exists()):
            sets = [part for one in setting.split() if one != "defaults" for part in ("--set", one)]
            report.write_text(call("render", scene, "--technique", technique, *sets, "--size", size, "--frames", frames,
                                   "--warmup", warmup, "--out", exr, "--json"))
        return exr, json.loads(report.read_text())

    lines = ["<!-- Made by docs/figures/horizon.py; do not edit. -->", ""]
    lines += error_table(options, call, render)
    lines += time_table(render)
    out = ROOT / "docs/techniques/horizon_figures.md"
    out.write_text("\n".join(lines).rstrip() + "\n")
    print(out)


def error_table(options, call, render):
    lines = [f"### Error against the one-bounce truth ({options.size}, {options.spp} paths per pixel)", "",
             "The truth holds the light of what the view does not show too, which neither technique can know.", "",
             "| scene | technique | setting | relMSE | nRMSE | bias |", "| --- | --- | --- | ---: | ---: | ---: |"]
    for scene in options.scenes:
        truth = options.work / f"{scene}_onebounce.exr"
        if not truth.exists():
            call("reference", scene, "--bounces", 1, "--spp", options.spp, "--size", options.size, "--out", truth)
        for technique, setting in SETTINGS:
            exr, _ = render(scene, technique, setting, options.size, 1, 0)
            e = json.loads(call("compare", exr, truth, "--json"))
            lines.append(f"| {scene} | {technique} | {setting} | {e['relMSE']:.3f} | {e['nrmse']:.3f} | {100 * e['bias']:+.1f} % |")
            if technique == "horizon" and setting == "defaults":
                call("triptych", exr, truth, "--out", ROOT / f"docs/images/horizon_{scene}.png")
    return lines + [""]


def time_table(render):
    lines = [f"### Time ({TIMED_SCENE}, {TIMED_SIZE}, ms)", "",
             "| technique | setting | " + " | ".join(f"`{p}`" for p in PASSES) + " | all |",
             "| --- | --- | " + " | ".join(["---:"] * (len(PASSES) + 1)) + " |"]
    for technique, setting in SETTINGS:
        if setting == LIMIT:
            continue
        _, report = render(TIMED_SCENE, technique, setting, TIMED_SIZE, 9, 2)
        times = {p["name"]: p["ms"] for p in report["passes"]}
        cells = [f"{times[p]:.1f}" if p in times else "" for p in PASSES]
        lines.append(f"| {technique} | {setting} | " + " | ".join(cells) + f" | {report['total_ms']:.1f} |")
    return lines


if __name__ == "__main__":
    main()
