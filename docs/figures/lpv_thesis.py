#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/lpv_thesis.md, and its pictures: the setting of ten Brug 2017 rebuilt, its scores beside ours.

    docs/figures/lpv_thesis.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--spp 128]

Crytek's Sponza is looked for in LIGHTWELL_SCENES. Sizes are the source's own. Truths of 128 paths a pixel take ten minutes each on two cores; they and
all pictures stay in --work and are made again only when missing: remove thesis_* to measure anew. Needs numpy, scipy and Pillow.
"""
import thesis_factor
import thesis_pictures
from lpv_thesis_scores import CASCADED, OURS, PUBLISHED, ROWS
from program import ROOT, read_options, write_between
from thesis_setting import SCENES, settings_of
from thesis_tables import Rows, own_table

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
SHOWN = {"LPV 32": ROWS["LPV 32"], "LPV 32, SSAO": ROWS["LPV 32, SSAO"], "LPV 64": ROWS["LPV 64"], "sweep 32, 3 bounces": OURS["sweep 32, 3 bounces"]}
NESTED = {"cascaded LPV 64": ROWS["cascaded LPV 64"]}


def main():
    options = read_options(__doc__, [], 128)
    settings, call = settings_of(options)
    has_cascades = "\n    cascades=" in call("render", "--help")
    rows = Rows(settings, ROWS, PUBLISHED, lambda scene, row: has_cascades or row not in CASCADED)
    beside = {row: what for row, what in {**ROWS, **OURS}.items() if row not in CASCADED and not (row.endswith("SSAO") and row in ROWS)}
    lines = []
    for scene in SCENES:
        lines += rows.table(scene) + own_table(settings, scene, beside)
    lines += rows.correlations() + rows.pairs_against() + thesis_factor.lines_of(rows, ("LPV 32", "LPV 64"))
    lines += thesis_pictures.write(settings, ROOT / "docs/images", "lpv_thesis", SHOWN, NESTED if has_cascades else {})
    if not has_cascades:
        lines += ["This program's `lpv` has no `cascades`: those rows are not measured.", ""]
    write_between(ROOT / "docs/techniques/lpv_thesis.md", BEGIN, END, lines)


if __name__ == "__main__":
    main()
