#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/lpv_leak.md, and its plot: light that lpv lets through a wall, by the wall's thickness.

    docs/figures/lpv_leak.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 160x120] [--spp 256]

Two closed rooms, a lamp in one. Needs numpy, scipy and matplotlib. What is measured lies in --work and is kept: remove leak_* to measure
anew.
"""
import json

import exr_planes
from program import ROOT, caller, read_options, write_between

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
CELL = 0.125           # m; a grid of 32 cells is 4 m wide
THICKNESSES = [0.25, 0.5, 1.0, 2.0, 3.0]  # cells
PHASES = [0.0, 0.25, 0.5, 0.75]  # cells by which a border of cells lies behind the wall's lit face
LAMPS = {"floor": [-1.2, 0.0, 0.0], "wall": [0.0, 0.5, 0.0]}  # what it shines on
VARIANTS = {
    "no geometry volume": ["geometry_volume=off"], "the same, damping": ["geometry_volume=off", "damping=on"],
    "geometry volume of the screen": ["geometry_volume=screen"], "the same, damping ": ["geometry_volume=screen", "damping=on"],
    "geometry volume of triangles": ["geometry_volume=triangles"], "the same, damping  ": ["geometry_volume=triangles", "damping=on"],
    "sweep": ["transport=sweep"]}
LIT, HEIGHT, HALF_WIDTH, OUTER = 1.75, 1.5, 0.75, 0.25  # m: a room's length, height, half its width, its outer walls' thickness


def scene(thickness, lamp):
    """The wall's lit face lies at x = 0 and stays there: it grows into the dark room."""
    def box(name, lower, upper):
        return {"name": name, "box": {"lower": lower, "upper": upper}, "material": "grey"}
    end, low, high, wide, out = LIT, -OUTER, HEIGHT + OUTER, HALF_WIDTH + OUTER, LIT + OUTER
    walls = [box("floor", [-out, low, -wide], [out, 0, wide]), box("ceiling", [-out, HEIGHT, -wide], [out, high, wide]),
             box("back", [-out, low, -wide], [out, high, -HALF_WIDTH]), box("front", [-out, low, HALF_WIDTH], [out, high, wide]),
             box("left", [-out, low, -wide], [-end, high, wide]), box("right", [end, low, -wide], [out, high, wide]),
             box("wall", [0, low, -wide], [thickness * CELL, high, wide])]
    dark = [LIT - 0.1, 1.3, 0.65]
    cameras = [{"name": "dark", "position": dark, "target": [thickness * CELL, 0.5, -0.3], "vertical_fov_degrees": 80},
               {"name": "lit", "position": [-dark[0], dark[1], dark[2]], "target": [0, 0.5, -0.3], "vertical_fov_degrees": 80}]
    light = {"name": "lamp", "kind": "spot", "position": [-0.9, 1.4, 0], "target": LAMPS[lamp], "intensity": 10,
             "inner_cone_degrees": 15, "outer_cone_degrees": 20}
    return {"materials": {"grey": {"albedo": 0.6}}, "meshes": walls, "cameras": cameras, "lights": [light], "sky": 0}


def main():
    options = read_options(__doc__, [], 256, "160x120")
    call = caller(options.lightwell)
    leaks = {}
    for lamp in LAMPS:
        for thickness in THICKNESSES:
            path = options.work / f"leak_{lamp}_{thickness}.json"
            path.write_text(json.dumps(scene(thickness, lamp)))
        lit = mean_light(options.work / f"leak_{lamp}_truth.exr", lambda exr: call(
            "reference", options.work / f"leak_{lamp}_{THICKNESSES[0]}.json", "--camera", "lit", "--bounces", 1, "--spp", options.spp,
            "--size", options.size, "--compact", "--out", exr))
        for variant, settings in VARIANTS.items():
            for thickness in THICKNESSES:
                leaks[lamp, variant, thickness] = [
                    leak(options, call, lamp, thickness, phase, settings) / lit for phase in PHASES]
    plot(leaks, ROOT / "docs/images/lpv_leak.svg")
    write_between(ROOT / "docs/techniques/lpv_leak.md", BEGIN, END, tables(leaks))


def leak(options, call, lamp, thickness, phase, settings):
    """Mean irradiance that the dark room's picture shows; it should show none."""
    # Neither floor nor walls lie on borders of cells; only the phase of the wall between is told apart.
    place = [f"extent={32 * CELL}", f"center_x={phase * CELL}", f"center_y={HEIGHT / 2 + 0.3 * CELL}", f"center_z={0.3 * CELL}"]
    name = "_".join([f"leak_{lamp}_{thickness}_{phase}", *settings]).replace("=", "")

    def make(exr):
        call("render", options.work / f"leak_{lamp}_{thickness}.json", "--camera", "dark", "--technique", "lpv", "--size", options.size,
             "--focus", "none", "--warmup", 0, "--frames", 1, *(part for s in ["size=32", *place, *settings] for part in ("--set", s)), "--out", exr)
    return mean_light(options.work / f"{name}.exr", make)


def mean_light(exr, make):
    if not exr.exists():
        make(exr)
    return exr_planes.read_planes(exr).mean()


def tables(leaks):
    lines = []
    for lamp in LAMPS:
        lines += [f"Lamp on the {'floor, none of its own light on the wall' if lamp == 'floor' else 'wall between'}; per cent, mean over four places "
                  "of the wall in its cell (most).", "",
                  "| | " + " | ".join(f"{t:g} cells" for t in THICKNESSES) + " |", "| --- | " + " | ".join(["---:"] * len(THICKNESSES)) + " |"]
        for variant in VARIANTS:
            cells = [leaks[lamp, variant, t] for t in THICKNESSES]
            lines.append(f"| {variant.strip()} | " + " | ".join(f"{number(sum(c) / len(c))} ({number(max(c))})" for c in cells) + " |")
        lines.append("")
    return lines + ["![Leak against thickness](../images/lpv_leak.svg)"]


def number(share):
    percent = 100 * share
    return f"{percent:.3g}" if percent >= 0.001 else "0" if percent == 0 else "<0.001"


def plot(leaks, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = "lpv_leak"  # the same file from the same figures
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True)
    colours = {"off": "C3", "screen": "C1", "triangles": "C0", "sweep": "C2"}
    for axes, lamp in zip(panels, LAMPS):
        for variant, settings in VARIANTS.items():
            means = [sum(leaks[lamp, variant, t]) / len(PHASES) for t in THICKNESSES]
            damped = "damping=on" in settings
            axes.plot(THICKNESSES, [max(m, 1e-6) for m in means], marker="o", ls="--" if damped else "-",
                      color=colours[settings[0].split("=")[1]], label=None if damped else variant)
        axes.set(title=f"lamp on the {lamp}", xlabel="wall's thickness, cells", yscale="log")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("light in the sealed room / light in the lit one")
    panels[0].legend(fontsize=7, title="dashed: damping", title_fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
