#!/usr/bin/env python3
"""Measures what the planner's rows take while light and geometry stand still and the host says so, into planner_data.json.

    docs/figures/planner_rest.py [--lightwell build/release/bin/lightwell] [--work build/planner_rest] [--date 2026-11-30] [--put]

Of rows of the table that read RSMs, of those with the same light the quickest, in five scenes: each with versions told beside itself without, in one sitting, as shares. --put: takes in what lies
in --work. Then docs/figures/planner.py fits anew.
"""
import json
import pathlib

import numpy as np

import planner
from planner_candidates import CANDIDATES, variant
from planner_measure import SIZE, charter, compact, is_point_of, read_points, rounded, time_of
from planner_model import DATA, Data, light_of, needs_light
from program import caller, read_work

WARMUP, FRAMES = 51, 15  # until VPLs of three bounces with clusters are kept, 16 updates each (docs/techniques/ssvp.md); measured ones
RESTED = ["cornell_original", "sibenik", "living_room", "breakfast_room", "level_zdm2"]
TOLD = "rsm_versions=on"


def main():
    options = read_work(__doc__, "planner_rest")
    data = Data()
    rows = quickest(data, [c for c in planner.rows_of_table(data) if needs_light(*data.candidates[c])])
    if not options.put:
        measure(options.lightwell, options.work, rows)
    put(options.work, options.date)


def quickest(data, candidates):
    """Of those whose light is the same."""
    ms = np.median(data.ms, axis=0)
    best = {}
    for c in sorted(candidates, key=lambda c: ms[c]):
        best.setdefault(light_of(data.candidates[c]), data.names()[c])
    return list(best.values())


def measure(program, work, rows):
    """Told and not told stand side by side: a slow minute falls on both."""
    techniques = [text for c in rows for text in (variant(c), f"{variant(c)},{TOLD}")]
    charter(caller(program), work)("chart", techniques, SIZE, FRAMES, "--warmup", WARMUP, "--scenes", *RESTED, "--cameras", "first", "--noise", "1e3")


def put(work, date):
    raw = json.loads(DATA.read_text())
    header, points = read_points(work / "chart")
    threads = int(header["header"]["versions"]["threads"])
    names = [c["technique"] + (" " + c["settings"] if c["settings"] else "") for c in raw["candidates"]]
    views = {}
    for p in points:
        if p["warm_up"] < WARMUP:
            raise SystemExit(f"{p['id']}: expected {WARMUP} frames before those that count, got {p['warm_up']}: too slow a machine to tell frames at rest")
        told = TOLD in p["settings"].split()
        plain = {**p, "settings": " ".join(s for s in p["settings"].split() if s != TOLD) or "defaults"}
        for candidate in CANDIDATES:
            if is_point_of(plain, candidate):
                views.setdefault((pathlib.Path(p["scene"]).stem, p["camera"]), {}).setdefault(candidate, {})[told] = time_of(p, threads)
    raw["rest"] = {"date": date, "frames": FRAMES, "after": WARMUP}
    raw["rest_shares"] = [{"scene": scene, "camera": camera,
                           "shares": [rounded(of[name][True] / of[name][False], 3) if len(of.get(name, {})) == 2 else None for name in names]}
                          for (scene, camera), of in views.items()]
    DATA.write_text(compact(raw), encoding="utf-8")
    print(DATA, len(views), "views")


if __name__ == "__main__":
    main()
