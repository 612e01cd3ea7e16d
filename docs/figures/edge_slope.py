#!/usr/bin/env python3
"""Writes the tables of docs/edge_slope.md and its picture: errors and passes' times with edges by one slope for all surfaces and by each surface's own.

    docs/figures/edge_slope.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--part errors times picture]

Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. Errors take some minutes where truths are cached; the charts below --work are kept. Times: on an
otherwise idle machine. For one slope for all the kernels are copied, and read from a copy in which the largest slope stands for each surface's own.
"""
import json
import os
import shutil
import statistics

from planner_measure import BLOCK, KEPT, SCENES
from program import ROOT, caller, read_options, write_between

PAGE, PICTURE = ROOT / "docs/edge_slope.md", ROOT / "docs/images/edge_slope.jpg"
ROWS = {"`rsm`, 64 VPLs, quarter": "rsm,vpls=64,resolution=quarter",
        "`ssvp`, 32 clusters, quarter": "ssvp,vpls=1024,clusters=32,second_vpls=16,visibility=careful,bounces=4,resolution=quarter",
        "`ssvp`, 64 clusters, quarter": "ssvp,vpls=1024,clusters=64,visibility=careful,bounces=4,resolution=quarter",
        "`ssvp`, 64 clusters, half": "ssvp,vpls=1024,clusters=64,visibility=careful,bounces=4,resolution=half"}
TIMED, PASSES, ROUNDS = ["quarter", "half", "full"], ["interleaved_gather.filter", "joint_bilateral.upsample"], 5
SHOWN = ["sponza_crytek", "--technique", "ssvp", "--set", *ROWS["`ssvp`, 64 clusters, quarter"].split(",")[1:], "--frames", 1]
CROP, GAP = (640, 90, 1120, 360), 4  # of 1280 x 720 pixels: left, top, right, bottom; pixels of white between the two


def main():
    options = read_options(__doc__, SCENES, 0, parts=("errors", "times", "picture"))
    call = caller(options.lightwell)
    ways = {"one": with_one_slope(options.work), "own": ROOT / "kernels"}
    if "errors" in options.part:
        write_between(PAGE, "<!-- begin: errors, written by docs/figures/edge_slope.py -->", "<!-- end: errors -->", error_table(options, call, ways))
    if "times" in options.part:
        write_between(PAGE, "<!-- begin: times, written by docs/figures/edge_slope.py -->", "<!-- end: times -->", time_table(options, call, ways))
    if "picture" in options.part:
        picture(options, call, ways)


def with_one_slope(work):
    folder = work / "kernels_one_slope"
    shutil.copytree(ROOT / "kernels", folder, dirs_exist_ok=True)
    (folder / "shared/edge_slope.h").write_text('#include "edge_weight.h"\n#include "neighbours.h"\n'
                                                "#define squared_edge_slope(...) ((real)(LW_EDGE_SLOPE * LW_EDGE_SLOPE))\n", encoding="utf-8")
    return folder


def errors_of(options, call, kernels, name):
    os.environ["LIGHTWELL_KERNEL_DIR"] = str(kernels)
    out = options.work / f"edge_slope_{name}"
    call("chart", "--out", out, "--size", options.size, "--judge-one-of", BLOCK, "--picture-noise", 0, "--no-report", "--frames", 1,
         "--techniques", *(row + ",seed=0" for row in ROWS.values()), "--scenes", *options.scenes, *KEPT, shown=True)
    return {p["id"]: p for p in json.loads((out / "results.json").read_text())["points"]}


def error_table(options, call, ways):
    found = {name: errors_of(options, call, kernels, name) for name, kernels in ways.items()}
    error = {name: {} for name in ways}
    for name, points in found.items():
        for p in points.values():
            row = next(label for label, row in ROWS.items() if p["technique"] == row.split(",")[0] and all(is_set(p, s) for s in row.split(",")[1:]))
            error[name].setdefault((p["scene"], row), []).append(p["errors"]["all"]["relMSE"])
    mean = {name: {key: statistics.geometric_mean(of) for key, of in errors.items()} for name, errors in error.items()}
    lines = ["| scene | " + " | ".join(ROWS) + " |", "| --- |" + " ---: |" * len(ROWS)]
    for scene in options.scenes:
        lines.append(f"| {scene} | " + " | ".join(f"{mean['one'][scene, row]:.2g}: x {mean['own'][scene, row] / mean['one'][scene, row]:.2f}" for row in ROWS) + " |")
    views = {row: [b / a for scene in options.scenes for a, b in zip(error["one"][scene, row], error["own"][scene, row])] for row in ROWS}
    return lines + ["| all views | " + " | ".join(f"x {statistics.geometric_mean(of):.2f}" for of in views.values()) + " |"]


def is_set(point, setting):
    key, value = setting.split("=")
    return str(point["parameters"][key]) == value


def time_table(options, call, ways):
    def passes(kernels, resolution):
        os.environ["LIGHTWELL_KERNEL_DIR"] = str(kernels)
        frame = json.loads(call("render", "sibenik", "--technique", "rsm", "--set", "vpls=64", f"resolution={resolution}", "--size", options.size, "--frames", 41, "--json"))
        return {p["name"]: p["ms"] for p in frame["passes"]}

    lines = ["| pass | " + " | ".join(f"{r} resolution" for r in TIMED) + " |", "| --- |" + " ---: |" * len(TIMED)]
    measured = {r: [{name: passes(kernels, r) for name, kernels in ways.items()} for _ in range(ROUNDS)] for r in TIMED}
    for name in PASSES:
        cells = []
        for rounds in measured.values():
            one, own = (statistics.median(taken[way].get(name, 0) for taken in rounds) for way in ("one", "own"))
            cells.append(f"{one:.2f} to {own:.2f}" if one else "none")
        lines.append(f"| `{name}` | " + " | ".join(cells) + " |")
    return lines


def picture(options, call, ways):
    """Both at the exposure of the first."""
    import numpy
    from PIL import Image

    exposure, shown = [], []
    for name, kernels in ways.items():
        os.environ["LIGHTWELL_KERNEL_DIR"] = str(kernels)
        file = options.work / f"edge_slope_{name}.png"
        report = json.loads(call("render", *SHOWN, "--size", options.size, "--json", "--out", file, *exposure))
        exposure = ["--exposure", report["exposure"]]
        shown.append(numpy.asarray(Image.open(file).convert("RGB").crop(CROP)))
    gap = numpy.full((shown[0].shape[0], GAP, 3), 255, numpy.uint8)
    Image.fromarray(numpy.hstack([shown[0], gap, shown[1]])).save(PICTURE, quality=88)
    print(PICTURE)


if __name__ == "__main__":
    main()
