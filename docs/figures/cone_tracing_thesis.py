#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/cone_tracing_thesis.md, and its pictures: voxel cone tracing in the setting of ten Brug 2017.

    docs/figures/cone_tracing_thesis.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--spp 128] [--part kept]

Crytek's Sponza is looked for in LIGHTWELL_SCENES. Sizes are the source's own. Truths are those of lpv_thesis.py; they and all pictures stay in --work
and are made again only when missing: remove thesis_*_cone_tracing_* to measure anew. --part kept:
only rows that lie there already, no pictures. Needs numpy, scipy and Pillow.
"""
import thesis_pictures
from cone_tracing_thesis_scores import OURS, PUBLISHED, ROWS
from cone_tracing_vao import gain_tables, vao_tables
from program import ROOT, read_options, write_between
from thesis_setting import SCENES, settings_of
from thesis_tables import Rows, own_table

BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
SHOWN = {row: ROWS[row] for row in ("isotropic 32", "SH 32", "SH 32, VAO", "SH 128")}
OF_SPONZA = {"cascaded SH 128": ROWS["cascaded SH 128"]}
# Pairs that the source has nearer than this are counted, not listed.
APART = 1.5


def kept(settings, scene, what):
    return all(settings[scene, view].is_measured(*what) for view in SCENES[scene]["views"])


def main():
    options = read_options(__doc__, [], 128, parts=("kept", "missing"))
    settings, _ = settings_of(options)
    everything = "missing" in options.part
    rows = Rows(settings, ROWS, PUBLISHED, lambda scene, row: everything or kept(settings, scene, ROWS[row]))
    lines = []
    for scene in SCENES:
        own = {row: what for row, what in OURS.items() if everything or kept(settings, scene, what)}
        lines += rows.table(scene) + own_table(settings, scene, own)
    lines += rows.correlations(by_error=True) + rows.pairs_against(APART) + vao_tables(rows, everything)
    if everything:
        lines += gain_tables(rows, ("isotropic 32", "SH 32"))
        lines += thesis_pictures.write(settings, ROOT / "docs/images", "cone_tracing_thesis",
                                       {**SHOWN, "normal-aware 128": OURS["normal-aware 128"]}, OF_SPONZA)
    write_between(ROOT / "docs/techniques/cone_tracing_thesis.md", BEGIN, END, lines)


if __name__ == "__main__":
    main()
