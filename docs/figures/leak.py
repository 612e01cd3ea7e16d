"""Light that a technique's grid lets through a wall between two closed rooms, by the wall's thickness. Used by lpv_leak.py and
cone_tracing_leak.py."""
import json

import exr_planes
from program import ROOT, caller, read_options, write_between

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
CELL = 0.125           # m; a grid of 32 cells is 4 m wide
THICKNESSES = [0.25, 0.5, 1.0, 2.0, 3.0]  # cells
LAMPS = {"floor": [-1.2, 0.0, 0.0], "wall": [0.0, 0.5, 0.0]}  # what it shines on
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


def measure(description, technique, variants, phases, style, dashes):
    """Writes a technique's table and plot. variants: settings by name; phases: cells by which a border of cells lies behind the wall's lit
    face; style(settings): a line's colour, whether it is dashed, and whether it is named; dashes: what dashed lines have."""
    options = read_options(description, [], 256, "160x120")
    call = caller(options.lightwell)
    leaks = {}
    for lamp in LAMPS:
        for thickness in THICKNESSES:
            path = options.work / f"leak_{lamp}_{thickness}.json"
            path.write_text(json.dumps(scene(thickness, lamp)))
        lit = mean_light(options.work / f"leak_{lamp}_truth.exr", lambda exr: call(
            "reference", options.work / f"leak_{lamp}_{THICKNESSES[0]}.json", "--camera", "lit", "--bounces", 1, "--spp", options.spp,
            "--size", options.size, "--compact", "--out", exr))
        for variant, settings in variants.items():
            for thickness in THICKNESSES:
                leaks[lamp, variant, thickness] = [
                    leak(options, call, lamp, thickness, phase, technique, settings) / lit for phase in phases]
    plot(leaks, variants, style, dashes, ROOT / f"docs/images/{technique}_leak.svg")
    write_between(ROOT / f"docs/techniques/{technique}_leak.md", BEGIN, END, tables(leaks, variants, len(phases), technique))


def leak(options, call, lamp, thickness, phase, technique, settings):
    """Mean irradiance that the dark room's picture shows; it should show none."""
    # Neither floor nor walls lie on borders of cells; only the phase of the wall between is told apart.
    place = [f"extent={32 * CELL}", f"center_x={phase * CELL}", f"center_y={HEIGHT / 2 + 0.3 * CELL}", f"center_z={0.3 * CELL}"]
    name = "_".join([f"leak_{lamp}_{thickness}_{phase}", *(() if technique == "lpv" else (technique,)), *settings]).replace("=", "")

    def make(exr):
        call("render", options.work / f"leak_{lamp}_{thickness}.json", "--camera", "dark", "--technique", technique, "--size", options.size,
             "--focus", "none", "--warmup", 0, "--frames", 1, *(part for s in ["size=32", *place, *settings] for part in ("--set", s)), "--out", exr)
    return mean_light(options.work / f"{name}.exr", make)


def mean_light(exr, make):
    if not exr.exists():
        make(exr)
    return exr_planes.read_planes(exr).mean()


def tables(leaks, variants, places, technique):
    lines = []
    words = {2: "two", 4: "four"}
    for lamp in LAMPS:
        lines += [f"Lamp on the {'floor, none of its own light on the wall' if lamp == 'floor' else 'wall between'}; per cent, mean over {words[places]} places "
                  "of the wall in its cell (most).", "",
                  "| | " + " | ".join(f"{t:g} cells" for t in THICKNESSES) + " |", "| --- | " + " | ".join(["---:"] * len(THICKNESSES)) + " |"]
        for variant in variants:
            cells = [leaks[lamp, variant, t] for t in THICKNESSES]
            lines.append(f"| {variant.strip()} | " + " | ".join(f"{number(sum(c) / len(c))} ({number(max(c))})" for c in cells) + " |")
        lines.append("")
    return lines + [f"![Leak against thickness](../images/{technique}_leak.svg)"]


def number(share):
    percent = 100 * share
    return f"{percent:.3g}" if percent >= 0.001 else "0" if percent == 0 else "<0.001"


def plot(leaks, variants, style, dashes, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams["svg.hashsalt"] = path.stem  # the same file from the same figures
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True)
    for axes, lamp in zip(panels, LAMPS):
        for variant, settings in variants.items():
            means = [sum(leaks[lamp, variant, t]) / len(leaks[lamp, variant, t]) for t in THICKNESSES]
            colour, dashed, named = style(settings)
            axes.plot(THICKNESSES, [max(m, 1e-6) for m in means], marker="o", ls="--" if dashed else "-", color=colour,
                      label=variant.strip() if named else None)
        axes.set(title=f"lamp on the {lamp}", xlabel="wall's thickness, cells", yscale="log")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("light in the sealed room / light in the lit one")
    panels[0].legend(fontsize=7, title=f"dashed: {dashes}", title_fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
