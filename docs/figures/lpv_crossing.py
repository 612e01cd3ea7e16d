#!/usr/bin/env python3
"""Writes the measured parts of docs/techniques/lpv_crossing.md, and its plot: how lpv's picture changes as its grids move on by cells, and
what that costs.

    docs/figures/lpv_crossing.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 320x180] [--spp 64]
                                 [--part flicker cost] [--before PROGRAM]

Crytek's Sponza is looked for in LIGHTWELL_SCENES. Camera, sun and shadow map rest and so does the truth: only what the grids lie around moves, so
that all that changes is theirs. Unsnapped is what the library does not do; it is measured by moving everything else through grids at rest.
Part `cost` wants nothing else running; --before names the program of another build, which then takes turns with the one measured.
Pictures and times lie in --work and are kept: remove lpv_crossing_* to measure anew. Needs numpy, scipy and matplotlib.
"""
import json

import numpy
from scipy.ndimage import median_filter

import exr_planes
import lpv_crossing_cost
from program import ROOT, caller, read_options, write_between

PAGE = ROOT / "docs/techniques/lpv_crossing.md"
BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
COST_BEGIN, COST_END = "<!-- begin: cost -->", "<!-- end: cost -->"
FRAMES = 13
FOCUS = [-2.1, 3.2, 0.1]           # m: ahead of the camera
STEP = [0.156, 0.017, 0.027]       # m a frame, askew: a quarter of the cell of 32 to 20 m, an eighth of that of 16
CAMERA = {"name": "view", "position": [-9.5, 2.2, -0.3], "target": [5, 3, 0], "vertical_fov_degrees": 55}
SUN = {"name": "sun", "kind": "sun", "direction": [0.12, -1, 0.08], "irradiance": 10}
EXTENTS = {1: 20, 3: 40}           # m, of the largest grid
TRANSPORTS = ["propagate", "sweep"]
SIZES = [16, 32]
TILES = (12, 20)                   # of the picture, as docs/stability.md has them
NAMES = ("R", "G", "B", "validity")


class Crossing:
    def __init__(self, options, mesh):
        self.options, self.call, self.mesh = options, caller(options.lightwell), mesh
        truth = options.work / "lpv_crossing_truth.exr"
        if not truth.exists():
            self.call("reference", self.scene([0, 0, 0], "rest"), "--bounces", 1, "--spp", options.spp, "--size", options.size, "--compact", "--out", truth)
        self.mean = exr_planes.read_planes(truth).mean()

    def scene(self, by, name):
        camera = {**CAMERA, **{key: [a + b for a, b in zip(CAMERA[key], by)] for key in ("position", "target")}}
        return scene_file(self.options, self.mesh, by, camera, name)

    def picture(self, frame, snapped, transport, size, cascades):
        way = [frame * s for s in STEP]
        # Grids begin at whole cells of the world around the focus. What moves with the focus, cells included, is a grid that does not snap.
        scene = self.scene([0, 0, 0], "rest") if snapped else self.scene([-w for w in way], f"moved{frame}")
        focus = [f + w for f, w in zip(FOCUS, way)] if snapped else FOCUS
        out = self.options.work / f"lpv_crossing_{transport}{size}_{cascades}_{'snapped' if snapped else 'free'}_{frame}.exr"
        if not out.exists():
            sets = [f"transport={transport}", f"size={size}", f"cascades={cascades}", f"extent={EXTENTS[cascades]}"]
            self.call("render", scene, "--technique", "lpv", *(part for s in sets for part in ("--set", s)), "--size", self.options.size,
                      "--focus", ",".join(f"{f:.6g}" for f in focus), "--warmup", 0, "--frames", 1, "--out", out)
        return exr_planes.read_planes(out, NAMES)

    def figures(self, *what):
        """Flicker, worst step of a tile, spike, and the steps of the whole picture frame by frame, all over the truth's mean light."""
        frames = [self.picture(f, *what) for f in range(FRAMES)]
        lit = numpy.all([f[..., 3] > 0 for f in frames], axis=0)  # in all of the grids' places
        light = numpy.stack([f[..., :3] for f in frames]) / self.mean
        steps = abs(numpy.diff(light, axis=0)).mean(axis=-1)
        before, middle, after = light[:-2], light[1:-1], light[2:]
        out = numpy.where((middle - before) * (middle - after) > 0, numpy.minimum(abs(middle - before), abs(middle - after)), 0).mean(axis=-1)
        sticking = tiles(out, lit)
        usual = median_filter(sticking, size=(5, 1), mode="nearest")
        return {"flicker": steps[:, lit].mean(), "step": tiles(steps, lit).max(), "spike": (sticking - usual).max(),
                "steps": steps[:, lit].mean(axis=1), "share": lit.mean()}


def scene_file(options, mesh, by, camera, name):
    path = options.work / f"lpv_crossing_{name}.json"
    path.write_text(json.dumps({"meshes": [{"file": mesh, "translate": by}], "cameras": [camera], "lights": [SUN]}))
    return path


def tiles(values, counted):
    """Means over the tiles of each frame; tiles of which less than half counts are 0."""
    rows, columns = (numpy.array_split(numpy.arange(n), t) for n, t in zip(counted.shape, TILES))
    made = []
    for r in rows:
        for c in columns:
            part = counted[numpy.ix_(r, c)]
            inside = values[:, r[0]:r[-1] + 1, c[0]:c[-1] + 1]
            made.append((inside * part).sum(axis=(1, 2)) / part.sum() if 2 * part.sum() >= part.size else numpy.zeros(len(values)))
    return numpy.stack(made, axis=1)


def main():
    options = read_options(__doc__, [], 64, "320x180", ["flicker", "cost"], more=["before"])
    mesh = next(s["path"] for s in json.loads(caller(options.lightwell)("scenes", "--json")) if s["name"] == "sponza_crytek")
    if "flicker" in options.part:
        flicker(Crossing(options, mesh))
    if "cost" in options.part:
        found = lpv_crossing_cost.measure(options, lambda camera, name: scene_file(options, mesh, [0, 0, 0], camera, name))
        write_between(PAGE, COST_BEGIN, COST_END, lpv_crossing_cost.tables(found))


def flicker(crossing):
    found = {(t, s, c, snapped): crossing.figures(snapped, t, s, c) for t in TRANSPORTS for s in SIZES for c in EXTENTS for snapped in (True, False)}
    plot(found, ROOT / "docs/images/lpv_crossing.svg")
    lines = ["| transport | cells | cascades | finest cell, m | cells crossed | flicker: snapped | not | worst step of a tile: snapped | not | "
             "spike: snapped | not |", "| --- " + "| ---: " * 10 + "|"]
    for transport in TRANSPORTS:
        for size in SIZES:
            for cascades in EXTENTS:
                a, b = (found[transport, size, cascades, snapped] for snapped in (True, False))
                cell = EXTENTS[cascades] / 2 ** (cascades - 1) / size
                crossed = (FRAMES - 1) * STEP[0] / cell
                lines.append(f"| {transport} | {size} | {cascades} | {cell:.3g} | {crossed:.1f} | " +
                             " | ".join(f"{x[key]:.2g}" for key in ("flicker", "step", "spike") for x in (a, b)) + " |")
    lines += ["", f"{FRAMES} frames of {crossing.options.size}; over pixels that all places of the grids hold "
              f"({100 * min(f['share'] for f in found.values()):.0f} % of the picture at least).", "", "![Frame by frame](../images/lpv_crossing.svg)"]
    write_between(PAGE, BEGIN, END, lines)


def plot(found, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = "lpv_crossing"  # the same file from the same figures
    figure, panels = plt.subplots(2, 2, figsize=(9, 5.2), sharex=True, sharey="row")
    for row, transport in zip(panels, TRANSPORTS):
        for axes, cascades in zip(row, EXTENTS):
            for size, colour in zip(SIZES, ("C0", "C1")):
                for snapped, style in ((True, "-"), (False, "--")):
                    axes.plot(range(1, FRAMES), found[transport, size, cascades, snapped]["steps"], style, color=colour, marker=".",
                              label=f"{size}^3, {'snapped' if snapped else 'not'}")
            axes.set_title(f"{transport}, {cascades} cascade{'s' if cascades > 1 else ''}", fontsize=9)
            axes.grid(alpha=0.3)
        row[0].set_ylabel("step / mean light")
    panels[0][0].legend(fontsize=7)
    for axes in panels[1]:
        axes.set_xlabel("frame")
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
