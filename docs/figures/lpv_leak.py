#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/lpv_leak.md, and its plot: light that lpv lets through a wall, by the wall's thickness.

    docs/figures/lpv_leak.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 160x120] [--spp 256]

Two closed rooms, a lamp in one. Needs numpy, scipy and matplotlib. What is measured lies in --work and is kept: remove leak_* to measure
anew.
"""
from leak import measure

PHASES = [0.0, 0.25, 0.5, 0.75]
VARIANTS = {
    "no geometry volume": ["geometry_volume=off"], "the same, damping": ["geometry_volume=off", "damping=on"],
    "geometry volume of the screen": ["geometry_volume=screen"], "the same, damping ": ["geometry_volume=screen", "damping=on"],
    "geometry volume of triangles": ["geometry_volume=triangles"], "the same, damping  ": ["geometry_volume=triangles", "damping=on"],
    "sweep": ["transport=sweep"]}
COLOURS = {"off": "C3", "screen": "C1", "triangles": "C0", "sweep": "C2"}


def style(settings):
    damped = "damping=on" in settings
    return COLOURS[settings[0].split("=")[1]], damped, not damped


if __name__ == "__main__":
    measure(__doc__, "lpv", VARIANTS, PHASES, style, "damping")
