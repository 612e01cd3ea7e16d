#!/usr/bin/env python3
"""Writes the part of docs/techniques/ssvp_visibility.md that holds voxels against maps, and its picture.

    docs/figures/voxel_visibility.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--spp 256]
        [--scenes cornell sponza_crytek living_room] [--part errors times page]

Errors at 480x270 against one bounce of path tracing, times at 1280x720. Measured once and kept in --work (voxels_*): remove what shall be
measured anew. Needs numpy and Pillow for the picture.
"""
import json
import statistics

import exr_planes
from program import ROOT, caller, read_options, write_between

BEGIN, END = "<!-- begin: voxels -->", "<!-- end: voxels -->"
SMALL, LARGE = "480x270", "1280x720"
ONE = "bounces=1"
VARIANTS = {
    "`rsm`, nothing blocks": ("rsm", []),
    "`rsm`, voxels 32": ("rsm", ["visibility=voxel", "voxels=32"]),
    "`rsm`, voxels 64": ("rsm", ["visibility=voxel", "voxels=64"]),
    "`rsm`, voxels 128": ("rsm", ["visibility=voxel", "voxels=128"]),
    "`ssvp`, 4 maps": ("ssvp", [ONE, "clusters=4"]),
    "`ssvp`, 8 maps": ("ssvp", [ONE, "clusters=8"]),
    "`ssvp`, 32 maps": ("ssvp", [ONE, "clusters=32"]),
    "`ssvp`, voxels 64, 8 clusters": ("ssvp", [ONE, "visibility=voxel", "voxels=64", "clusters=8"]),
    "`ssvp`, voxels 128, 8 clusters": ("ssvp", [ONE, "visibility=voxel", "voxels=128", "clusters=8"])}
ANEW = ("paraboloid_map", "voxel_visibility", "voxel_grid")
SHOWN = ["`rsm`, nothing blocks", "`rsm`, voxels 64", "`ssvp`, 32 maps"]
RUNS, FRAMES = 2, 9


def main():
    options = read_options(__doc__, ["cornell", "sponza_crytek", "living_room"], 256, parts=["errors", "times", "page"])
    call = caller(options.lightwell)

    def render(scene, variant, size, frames, warmup, out):
        technique, settings = VARIANTS[variant]
        sets = [part for setting in settings for part in ("--set", setting)]
        return json.loads(call("render", scene, "--technique", technique, *sets, "--size", size, "--frames", frames, "--warmup", warmup,
                               "--out", out, "--json"))

    for scene in options.scenes:
        if "errors" in options.part:
            find_errors(options, call, render, scene)
        if "times" in options.part:
            find_times(options, render, scene)
    if "page" in options.part:
        write_between(ROOT / "docs/techniques/ssvp_visibility.md", BEGIN, END, page(options))
        draw(options)


def picture(options, scene, variant):
    return options.work / f"voxels_{scene}_{list(VARIANTS).index(variant)}.exr"


def truth(options, scene):
    return options.work / f"voxels_{scene}_truth.exr"


def find_errors(options, call, render, scene):
    if not truth(options, scene).exists():
        call("reference", scene, "--size", SMALL, "--bounces", 1, "--spp", options.spp, "--out", truth(options, scene))
    path = options.work / f"voxels_{scene}_errors.json"
    errors = json.loads(path.read_text()) if path.exists() else {}
    for variant in VARIANTS:
        if variant not in errors:
            exr = picture(options, scene, variant)
            render(scene, variant, SMALL, 1, 2, exr)
            errors[variant] = json.loads(call("compare", exr, truth(options, scene), "--json"))
            path.write_text(json.dumps(errors))


def find_times(options, render, scene):
    """The variants take turns, so that a slow minute falls on all of them."""
    path = options.work / f"voxels_{scene}_times.json"
    if path.exists():
        return
    rest, anew = {variant: [] for variant in VARIANTS}, {}
    for run in range(RUNS):
        for variant in VARIANTS:
            exr = options.work / "voxels.exr"
            rest[variant].append(render(scene, variant, LARGE, FRAMES, 4, exr)["total_ms"])
            if run == 0:
                first = render(scene, variant, LARGE, 1, 0, exr)
                anew[variant] = sum(p["ms"] for p in first["passes"] if p["name"].startswith(ANEW))
    path.write_text(json.dumps({"rest": {v: statistics.median(t) for v, t in rest.items()}, "anew": anew}))


def page(options):
    cells = {scene: [json.loads((options.work / f"voxels_{scene}_{what}.json").read_text()) for what in ("errors", "times")]
             for scene in options.scenes}
    noise = ", ".join(f"{cells[scene][0][SHOWN[0]]['reference_noise']:.2g}" for scene in options.scenes)
    lines = [f"relMSE / nRMSE against one bounce of path tracing at {SMALL} ({options.spp} paths a pixel, noise {noise}); milliseconds of a frame at rest at "
             f"{LARGE}, and of what is drawn where lights or surfaces move: maps, or voxels and what clusters see past them.", "",
             "| | " + " | ".join(f"{scene} | ms | anew" for scene in options.scenes) + " |",
             "| --- |" + " ---: |" * (3 * len(options.scenes))]
    for variant in VARIANTS:
        row = []
        for errors, times in cells.values():
            row += [f"{errors[variant]['relMSE']:.2g} / {errors[variant]['nrmse']:.2f}", f"{times['rest'][variant]:.1f}",
                    f"{times['anew'][variant]:.1f}" if times["anew"][variant] > 0.05 else ""]
        lines.append(f"| {variant} | " + " | ".join(row) + " |")
    return lines + ["", f"Rows: {', '.join(options.scenes)}. Left to right: truth; {'; '.join(name.replace('`', '') for name in SHOWN)}.", "",
                    "![Truth, rsm, rsm with voxels, ssvp with maps](../images/voxel_visibility.jpg)"]


def draw(options):
    import numpy
    from PIL import Image
    rows = []
    for scene in options.scenes:
        planes = [exr_planes.read_planes(path) for path in [truth(options, scene), *(picture(options, scene, v) for v in SHOWN)]]
        mean = planes[0].mean()
        rows.append(numpy.concatenate([(numpy.maximum(p, 0.0) / (numpy.maximum(p, 0.0) + mean)) ** (1 / 2.2) for p in planes], axis=1))
    pixels = (numpy.clip(numpy.concatenate(rows), 0.0, 1.0) * 255.0 + 0.5).astype(numpy.uint8)
    Image.fromarray(pixels).save(ROOT / "docs/images/voxel_visibility.jpg", quality=88)


if __name__ == "__main__":
    main()
