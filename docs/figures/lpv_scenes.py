#!/usr/bin/env python3
"""Writes what technique lpv is off by in scenes: tables and pictures of docs/techniques/lpv.md, lpv_range.md and lpv_sweep.md.

    docs/figures/lpv_scenes.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 480x270] [--spp 64]
                               [--part steps range sweep half bounces cascades times pictures]

`times` (of several grids, at 1280x720) wants nothing else running and is left out unless --part names it. Against path-traced truths of one bounce,
for `bounces` of two; what is rendered and judged lies in --work and is kept: remove lpv_scenes_* to measure anew. Crytek's Sponza is looked for in
LIGHTWELL_SCENES.
"""
import json

from program import ROOT, caller, read_options, write_between

SCENES = {"cornell": "Cornell", "rooms": "rooms", "sponza_crytek": "Sponza"}
PAGES = {"steps": "lpv", "range": "lpv_range", "sweep": "lpv_sweep", "half": "lpv_sweep", "bounces": "lpv_sweep", "cascades": "lpv"}
PARTS = ["steps", "range", "sweep", "half", "bounces", "cascades", "times", "pictures"]
RSM = "rsm vpls=1024"
STEPS = ["size=16", "size=32", "damping=on", "geometry_volume=screen", "steps=16", "size=64", "geometry_volume=off", RSM]
DEFAULT = "size=32"  # which is 64 steps of propagation
RANGE = ["steps=16", "steps=32", DEFAULT, "auto_error=0.2", "auto_error=0.1", "auto_error=0.05", "auto_error=0.05 steps=256",
         "transport=coarse_to_fine", "transport=coarse_to_fine size=64", "transport=sweep size=32"]
SWEEP = ["transport=sweep size=16", "transport=sweep size=32", "transport=sweep size=64", "geometry_volume=off", RSM]
HALF = ["transport=sweep size=16", "transport=sweep size=32", "size=32"]
BOUNCES = ["transport=sweep size=32 bounces=2"]
CASCADES = ["transport=sweep size=32", "transport=sweep size=16", "size=32"]
TIMED = "1280x720"
# Passes of the columns of times; what is not among them is in the frame's.
COLUMNS = {"transport": ("lpv_sweep.march", "lpv_sweep.combine", "lpv_propagation.wave", "lpv_propagation.step", "lpv_cascades.add"),
           "inject": ("lpv_sweep.inject", "lpv_sweep.resolve", "lpv_grid.inject", "lpv_grid.resolve"),
           "reading": ("lpv_sweep.pack", "lpv_sweep.gather", "lpv_read.pack", "lpv_read.gather")}
PICTURES = {"cornell_lpv": ("cornell", "size=32"), "rooms_lpv": ("rooms", "size=32"), "sponza_lpv": ("sponza_crytek", "size=32"),
            "cornell_lpv_sweep": ("cornell", "transport=sweep size=16"), "sponza_lpv_sweep": ("sponza_crytek", "transport=sweep size=32"),
            "sponza_lpv_cascades": ("sponza_crytek", "transport=sweep size=32 cascades=3")}


class Scenes:
    def __init__(self, options):
        self.options, self.call = options, caller(options.lightwell)

    def path(self, *words):
        return self.options.work / ("lpv_scenes_" + "_".join(words).replace(" ", "_").replace("=", "") + ".exr")

    def truth(self, scene, bounces=1):
        out = self.path("truth", scene, str(bounces))
        if not out.exists():
            self.call("reference", scene, "--bounces", bounces, "--spp", self.options.spp, "--size", self.options.size, "--compact", "--out", out)
        return out

    def render(self, scene, settings, size, *more):
        technique, sets = ("rsm", settings.split()[1:]) if settings.startswith("rsm") else ("lpv", settings.split())
        return json.loads(self.call("render", scene, "--technique", technique, *(part for s in sets for part in ("--set", s)), "--size", size,
                                    *more, "--json"))

    def picture(self, scene, settings):
        return self.path(scene, settings)

    def judged(self, scene, settings, bounces=1):
        """Errors, with what the render says of itself."""
        out = self.picture(scene, settings)
        kept = out.with_suffix(".json")
        if not kept.exists():
            made = self.render(scene, settings, self.options.size, "--warmup", 0, "--frames", 1, "--out", out)
            found = json.loads(self.call("compare", out, self.truth(scene, bounces), "--json"))
            found.update(counts=made["counts"], bytes=made["bytes"])
            kept.write_text(json.dumps(found, indent=1), encoding="utf-8")
        return json.loads(kept.read_text(encoding="utf-8"))

    def timed(self, settings):
        kept = self.path("times", settings).with_suffix(".json")
        if not kept.exists():
            kept.write_text(json.dumps(self.render("sponza_crytek", settings, TIMED, "--warmup", 3, "--frames", 7)), encoding="utf-8")
        return json.loads(kept.read_text(encoding="utf-8"))


def main():
    options = read_options(__doc__, list(SCENES), 64, "480x270", PARTS, [part for part in PARTS if part != "times"])
    bench = Scenes(options)
    if "times" in options.part:
        for settings in nested():
            bench.timed(settings)
    tables = {"steps": steps, "range": by_steps, "sweep": sweep, "half": half, "bounces": bounces, "cascades": cascades}
    for part, page in PAGES.items():
        if part in options.part or (part == "cascades" and "times" in options.part):
            write_between(ROOT / f"docs/techniques/{page}.md", f"<!-- begin: {part}, by docs/figures/lpv_scenes.py -->", f"<!-- end: {part} -->",
                          tables[part](bench))
    if "pictures" in options.part:
        for name, (scene, settings) in PICTURES.items():
            bench.judged(scene, settings)
            bench.call("triptych", bench.picture(scene, settings), bench.truth(scene), "--out", ROOT / f"docs/images/{name}.png")


def table(heads, rows):
    return ["| | " + " | ".join(heads) + " |", "| --- |" + " ---: |" * len(heads)] + [f"| {title} | " + " | ".join(cells) + " |" for title, cells in rows]


def short(value):
    return f"{value:#.2g}".rstrip(".") if value < 99.5 else f"{value:.0f}"


def full(found):
    return [short(found["relMSE"]), f"{found['nrmse']:.2f}", f"{found['bias']:+.2f}", f"{found['score']:.1f}"]


def of_scenes(bench, settings):
    heads = [f"{title} {head}" if head == "relMSE" else head for title in SCENES.values() for head in ("relMSE", "nRMSE", "bias", "score")]
    return table(heads, [(f"`{s}`", [cell for scene in SCENES for cell in full(bench.judged(scene, s))]) for s in settings])


def steps(bench):
    return of_scenes(bench, STEPS)


def sweep(bench):
    return of_scenes(bench, SWEEP)


def by_steps(bench):
    def cell(scene, settings):
        found = bench.judged(scene, settings)
        taken = f"{found['counts']['steps']}: " if "sweep" not in settings else ""
        return taken + short(found["relMSE"])
    return table(list(SCENES.values()), [(f"`{'steps=64' if s == DEFAULT else s}`", [cell(scene, s) for scene in SCENES]) for s in RANGE])


def half(bench):
    def cells(settings):
        for scene in SCENES:
            for resolution in ("", " resolution=half"):
                found = bench.judged(scene, settings + resolution)
                yield f"{short(found['relMSE'])}, {found['nrmse']:.2f}"
    heads = [head for title in SCENES.values() for head in (f"{title} full", "half")]
    return table(heads, [(f"`{s}`", list(cells(s))) for s in HALF])


def bounces(bench):
    scenes = [scene for scene in SCENES if scene != "sponza_crytek"]
    heads = [f"{SCENES[scene]} {head}" if head == "relMSE" else head for scene in scenes for head in ("relMSE", "nRMSE", "bias", "score")]
    return table(heads, [(f"`{s}`", [cell for scene in scenes for cell in full(bench.judged(scene, s, 2))]) for s in BOUNCES])


def nested():
    return [s + more for s in CASCADES for more in ("", " cascades=3")]


def cascades(bench):
    timed = all(bench.path("times", s).with_suffix(".json").exists() for s in nested())
    heads = ["relMSE", "nRMSE", "bias", "score"] + ([f"{column}, ms" for column in (*COLUMNS, "frame")] + ["MB"] if timed else [])
    return table(heads, [(f"`{s}`", full(bench.judged("sponza_crytek", s)) + (times(bench.timed(s)) if timed else [])) for s in nested()])


def times(made):
    of = {p["name"]: p["ms"] for p in made["passes"]}
    sums = [sum(of.get(name, 0) for name in names) for names in COLUMNS.values()] + [made["total_ms"]]
    return [short(t) for t in sums] + [f"{made['bytes']['device'] / 1e6:.0f}"]


if __name__ == "__main__":
    main()
