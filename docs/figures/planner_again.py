#!/usr/bin/env python3
"""Measures errors of some of the planner's candidates once more, after a change of their light, and puts them into planner_data.json.

    docs/figures/planner_again.py --rows visibility=careful [--lightwell build/release/bin/lightwell] [--work build/planner_again] [--date 2026-11-30]

--rows: what the settings of those candidates contain. In all views and made-up scenes, of as many sample sets as the data has; times stay. What has been measured lies in --work and is
kept: hours where truths are not cached. Then docs/figures/planner.py fits anew.
"""
import argparse
import datetime
import json
import pathlib
import statistics

import planner_scenes
from planner_candidates import CANDIDATES, is_drawn, parted, variant
from planner_measure import BLOCK, MADE_TRUTH, MORE_SEEDS, SCENES, SEEDS, SIZE, TRUTH, UNSURE, compact, rounded, seed_errors
from planner_model import DATA
from program import ROOT, caller


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", required=True)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/planner_again")
    parser.add_argument("--date", default=datetime.date.today().isoformat())
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    rows = [c for c in CANDIDATES if options.rows in c and is_drawn(c)]
    measure(options.lightwell, options.work, rows)
    put(options.work, rows, options.date)


def measure(program, work, rows):
    lightwell = caller(program)

    def chart(folder, sets, *more):
        for seed in sets:
            lightwell("chart", "--out", work / f"{folder}{seed}", "--size", f"{SIZE[0]}x{SIZE[1]}", "--judge-one-of", BLOCK, "--picture-noise", 0, "--no-report", "--frames", 1,
                      "--techniques", *(f"{variant(c)},seed={seed}" for c in rows), *more, shown=True)

    chart("seeds", (0, *SEEDS), "--scenes", *SCENES, *TRUTH)
    chart("seeds", MORE_SEEDS, "--scenes", *UNSURE, *TRUTH)
    chart("train", (0, *SEEDS), "--scenes", *planner_scenes.write(work / "made"), *MADE_TRUTH)


def put(work, rows, date):
    data = json.loads(DATA.read_text())
    data["date"] = date
    names = [(c["technique"], c["settings"]) for c in data["candidates"]]
    for folder, views, errors in (("seeds", "views", "errors"), ("train", "made_views", "made_errors")):
        index = {(v["scene"], v["camera"]): i for i, v in enumerate(data[views])}
        known = seed_errors(sorted(work.glob(f"{folder}[0-9]*/results.json")), index)
        for candidate in rows:
            of = names.index(parted(candidate))
            for v in range(len(data[views])):
                found = known[v, CANDIDATES.index(candidate)]
                data[errors][v][of] = rounded(statistics.geometric_mean(found.values()))
    DATA.write_text(compact(data), encoding="utf-8")
    print(DATA)


if __name__ == "__main__":
    main()
