#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/cone_tracing_leak.md, and its plot: light that cones take through a wall, by its thickness.

    docs/figures/cone_tracing_leak.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 160x120] [--spp 256]

Two closed rooms, a lamp in one, those of lpv_leak.py. Needs numpy, scipy and matplotlib. What is measured lies in --work and is kept:
remove leak_*_cone_tracing_* to measure anew.
"""
from leak import measure

PHASES = [0.0, 0.5]
PLAIN, AWARE = ["resolution=full", "normal_aware=off"], ["resolution=full", "normal_aware=on"]
VARIANTS = {
    "isotropic": ["mode=isotropic", *PLAIN], "isotropic, normal-aware": ["mode=isotropic", *AWARE],
    "anisotropic": ["mode=anisotropic", *PLAIN], "anisotropic, directional opacity": ["mode=anisotropic", "directional_opacity=on", *PLAIN],
    "anisotropic, normal-aware": ["mode=anisotropic", *AWARE], "SH2": ["mode=sh2", *PLAIN], "SH2, normal-aware": ["mode=sh2", *AWARE]}
COLOURS = {"mode=isotropic": "C3", "mode=anisotropic": "C0", "mode=sh2": "C2"}


def style(settings):
    aware = "normal_aware=on" in settings
    return COLOURS[settings[0]], aware, not aware and "directional_opacity=on" not in settings


if __name__ == "__main__":
    measure(__doc__, "cone_tracing", VARIANTS, PHASES, style, "normal-aware")
