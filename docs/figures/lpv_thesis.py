#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/lpv_thesis.md, and its pictures: the setting of ten Brug 2017 rebuilt, its scores beside ours.

    docs/figures/lpv_thesis.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--spp 128]

Crytek's Sponza is looked for in LIGHTWELL_SCENES. Sizes are the source's own. Truths of 128 paths a pixel take ten minutes each on two cores; they and
all pictures stay in --work and are made again only when missing: remove lpv_thesis_* to measure anew. Needs numpy, scipy and Pillow.
"""
import functools
import json

import exr_planes
import lpv_thesis_factor
import lpv_thesis_pictures
from lpv_thesis_scores import CASCADED, OURS, PUBLISHED, ROWS, SCENES
from program import ROOT, caller, read_options, write_between

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
COLOURS = ("R", "G", "B")
SHADING = [f"{layer}.{c}" for layer in ("direct", "albedo", "normal") for c in COLOURS]
# The hemisphere of the source's SSAO, evenly covered and packed towards its centre; its radius is not published.
SSAO = ["method=ssao", "weighting=uniform", "resolution=full"]
SPONZA = {"cameras": [{"name": "overview", "position": [-9.5, 2.2, -0.3], "target": [5, 3, 0], "vertical_fov_degrees": 55},
                      {"name": "cloth", "position": [-6.0, 2.0, 0.8], "target": [-2.0, 1.9, 3.2], "vertical_fov_degrees": 45}],
          "lights": [{"name": "sun", "kind": "sun", "direction": [0.15, -1, 0.33], "irradiance": 10}]}


class Setting:
    """Pictures of one view, and what they are worth against its truth."""

    def __init__(self, options, call, scene, view):
        self.options, self.call, self.scene, self.view = options, call, scene, view
        self.file = scene_file(options, call, scene)

    @functools.cached_property
    def truth(self):
        out = self.path("truth")
        if not out.exists():
            self.lightwell("reference", "--bounces", "all", "--spp", self.options.spp, "--half", "--out", out)
        return out

    def path(self, name):
        return self.options.work / f"lpv_thesis_{self.scene}_{self.view}_{name}.exr"

    def lightwell(self, command, *arguments):
        return self.call(command, self.file, "--camera", self.view, "--size", SCENES[self.scene]["size"], *arguments)

    def render(self, technique, settings, *more):
        out = self.path("_".join([technique, *settings, *more]).replace("=", "").replace("--quantity_", ""))
        if not out.exists():
            self.lightwell("render", "--technique", technique, "--warmup", 0, "--frames", 1,
                           *(part for s in settings for part in ("--set", s)), *more, "--out", out)
        return out

    def row(self, technique, settings, occluded):
        """The picture of a row: the technique's, its indirect light times ambient occlusion where the row has it."""
        picture = self.render(technique, settings)
        if not occluded:
            return picture
        out = picture.with_name(picture.stem + "_ssao.exr")
        if not out.exists():
            planes = exr_planes.read_planes(picture, [*COLOURS, *SHADING])
            planes[..., :3] *= exr_planes.read_planes(self.render("ao", SSAO, "--quantity", "ambient-occlusion"), ("R",))
            write(out, planes)
        return out

    def part(self, layer):
        """A layer of the truth as a picture of its own: "bounce1", the first bounce; "a.all" and "b.all", halves of the paths."""
        out = self.path("truth_" + layer)
        if not out.exists():
            write(out, exr_planes.read_planes(self.truth, [*(f"{layer}.{c}" for c in COLOURS), *SHADING]))
        return out

    def figures(self, picture, truth=None):
        kept = picture.with_suffix(".one.json" if truth else ".json")
        if not kept.exists():
            kept.write_text(self.call("compare", picture, truth or self.truth, "--json"))
        return json.loads(kept.read_text())

    def floor(self):
        """Score of one half of the truth's paths against the other: what noise alone costs, twice over."""
        return self.figures(self.part("a.all"), self.part("b.all"))["score"]


def write(path, planes):
    exr_planes.write_planes(path, {name: planes[..., i] for i, name in enumerate([*COLOURS, *SHADING])})


def scene_file(options, call, scene):
    if scene != "sponza":
        return scene
    path = options.work / "lpv_thesis_sponza.json"
    mesh = next(s["path"] for s in json.loads(call("scenes", "--json")) if s["name"] == "sponza_crytek")
    path.write_text(json.dumps({"meshes": [{"file": mesh}], **SPONZA}))
    return path


def main():
    options = read_options(__doc__, [], 128)
    call = caller(options.lightwell)
    has_cascades = "\n    cascades=" in call("render", "--help")
    lines, ours = [], {}
    settings = {(scene, view): Setting(options, call, scene, view) for scene, s in SCENES.items() for view in s["views"]}

    def rows_of(scene):
        return [row for row in ROWS if row in PUBLISHED[scene, SCENES[scene]["views"][0]] and (has_cascades or row not in CASCADED)]
    for scene in SCENES:
        lines += score_table(settings, scene, rows_of(scene), ours) + own_table(settings, scene)
    lines += correlations(ours) + pairs_against(ours) + lpv_thesis_factor.lines_of(settings, rows_of)
    lines += lpv_thesis_pictures.write(settings, rows_of, ROOT / "docs/images")
    if not has_cascades:
        lines += ["This program's `lpv` has no `cascades`: those rows are not measured.", ""]
    write_between(ROOT / "docs/techniques/lpv_thesis.md", BEGIN, END, lines)


def score_table(settings, scene, measured, ours):
    views = SCENES[scene]["views"]
    first = [settings[scene, view] for view in views]
    noise = ", ".join(f"`{s.view}` {s.figures(s.row(*ROWS[measured[0]]))['reference_noise']:.2g} and {s.floor():.2f}" for s in first)
    lines = [f"### {SCENES[scene]['title']} ({SCENES[scene]['size']})", "",
             f"Truths' noise (relMSE), and the score of one half of their paths against the other: {noise}.", "",
             "| | " + " | ".join(f"{v}: source | ours | relMSE | bias" for v in views) + " | mean: source | ours |",
             "| --- | " + " | ".join(["---:"] * (4 * len(views) + 2)) + " |"]
    for row in PUBLISHED[scene, views[0]]:
        cells = []
        for view in views:
            theirs = PUBLISHED[scene, view][row]
            if row not in measured:
                cells.append(f"{theirs:.2f} | | | ")
                continue
            found = settings[scene, view].figures(settings[scene, view].row(*ROWS[row]))
            ours[scene, view, row] = found["score"]
            cells.append(f"{theirs:.2f} | {found['score']:.2f} | {found['relMSE']:.3g} | {percent(found['bias'])}")
        mean = sum(PUBLISHED[scene, v][row] for v in views) / len(views)
        own = f"{sum(ours[scene, v, row] for v in views) / len(views):.2f}" if row in measured else ""
        lines.append(f"| {row} | " + " | ".join(cells) + f" | {mean:.2f} | {own} |")
    return lines + [""]


def own_table(settings, scene):
    """What the source did not have, against the same truths; relMSE against one bounce as well, which is all that most of them carry."""
    views = SCENES[scene]["views"]
    lines = ["Beside them, against the same truths; *of one*: relMSE against the first bounce alone:", "",
             "| | " + " | ".join(f"{v}: score | relMSE | of one | bias" for v in views) + " |",
             "| --- | " + " | ".join(["---:"] * 4 * len(views)) + " |"]
    for row, what in {**ROWS, **OURS}.items():
        if row in CASCADED or row.endswith("SSAO") and row in ROWS:
            continue
        cells = []
        for view in views:
            setting = settings[scene, view]
            picture = setting.row(*what)
            found, one = setting.figures(picture), setting.figures(picture, setting.part("bounce1"))
            cells.append(f"{found['score']:.2f} | {found['relMSE']:.3g} | {one['relMSE']:.3g} | {percent(found['bias'])}")
        lines.append(f"| {row} | " + " | ".join(cells) + " |")
    return lines + [""]


def percent(share):
    return f"{100 * share:+.0f} %"


def series(ours):
    """(name, rows, theirs, ours): of each view, of means of views, of all of them together."""
    made = []
    for scene, s in SCENES.items():
        rows = [row for row in ROWS if (scene, s["views"][0], row) in ours]
        for view in s["views"]:
            made.append((f"{s['title']}, {view}", rows, [PUBLISHED[scene, view][r] for r in rows], [ours[scene, view, r] for r in rows]))
        made.append((f"{s['title']}, mean", rows, [sum(PUBLISHED[scene, v][r] for v in s["views"]) / 2 for r in rows],
                     [sum(ours[scene, v, r] for v in s["views"]) / 2 for r in rows]))
    for name, part in (("all views", "mean"), ("both means", None)):
        chosen = [m for m in made if m[0].endswith("mean") == (part is None)]
        made.append((name, [f"{m[0]}: {r}" for m in chosen for r in m[1]], sum((m[2] for m in chosen), []), sum((m[3] for m in chosen), [])))
    return made


def correlations(ours):
    from scipy.stats import kendalltau, spearmanr

    lines = ["### The ordering", "", "| | rows | Spearman | Kendall | pairs the other way round |", "| --- | ---: | ---: | ---: | ---: |"]
    for name, rows, theirs, found in series(ours):
        pairs = list(turned(rows, theirs, found))
        total = len(rows) * (len(rows) - 1) // 2
        lines.append(f"| {name} | {len(rows)} | {spearmanr(theirs, found)[0]:+.2f} | {kendalltau(theirs, found)[0]:+.2f} | {len(pairs)} of {total} |")
    return lines + [""]


def turned(rows, theirs, found):
    """Pairs of rows that one order has the other way round, as the source has them: better first."""
    for i, better in enumerate(rows):
        for j, worse in enumerate(rows):
            if theirs[i] > theirs[j] and found[i] < found[j]:
                yield better, worse, theirs[i] - theirs[j], found[j] - found[i]


def pairs_against(ours):
    lines = ["Pairs of one view that stand the other way round, as the source has them:", "",
             "| view | better in the source | than | by | here worse by |", "| --- | --- | --- | ---: | ---: |"]
    for name, rows, theirs, found in series(ours)[:-2]:
        if not name.endswith("mean"):
            lines += [f"| {name} | {a} | {b} | {x:.2f} | {y:.2f} |" for a, b, x, y in turned(rows, theirs, found)]
    return lines + [""]


if __name__ == "__main__":
    main()
