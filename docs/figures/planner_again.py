#!/usr/bin/env python3
"""Measures errors of some of the planner's candidates once more, after a change of their light, and puts them into planner_data.json.

    docs/figures/planner_again.py --rows visibility=careful [--lightwell build/release/bin/lightwell] [--work build/planner_again] [--date 2026-11-30]

--rows: what the settings of those candidates contain. In all views and made-up scenes, of as many sample sets as the data has; times stay. What has been measured lies in --work and is
kept: hours where truths are not cached. Then docs/figures/planner.py fits anew. Of what `planner.py --collect` takes in nothing changes: it would bring the old errors back.
"""
import argparse
import datetime
import json
import pathlib
import statistics

import planner
import planner_scenes
from planner_candidates import CANDIDATES, barred, is_drawn, parted, variant
from planner_measure import BLOCK, KEPT, MADE_TRUTH, MORE_SEEDS, SCENES, SEEDS, SIZE, TRUTH, UNSURE, compact, rounded, seed_errors
from planner_model import DATA, Data
from program import ROOT, caller


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", required=True)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/planner_again")
    parser.add_argument("--date", default=datetime.date.today().isoformat())
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    rows = [c for c in CANDIDATES if options.rows in c and is_drawn(c) and "voxel" not in c and c not in barred(CANDIDATES)]
    measure(options.lightwell, options.work, rows)
    put(options.work, rows, options.rows, options.date)


def measure(program, work, rows):
    lightwell = caller(program)

    def chart(folder, sets, *more):
        for seed in sets:
            lightwell("chart", "--out", work / f"{folder}{seed}", "--size", f"{SIZE[0]}x{SIZE[1]}", "--judge-one-of", BLOCK, "--picture-noise", 0, "--no-report", "--frames", 1,
                      "--techniques", *(f"{variant(c)},seed={seed}" for c in rows), *more, shown=True)

    made = planner_scenes.write(work / "made")
    chart("seeds", (0,), "--scenes", *SCENES, *TRUTH)
    chart("seeds", SEEDS, "--scenes", *SCENES, *KEPT)
    chart("seeds", MORE_SEEDS, "--scenes", *UNSURE, *KEPT)
    chart("train", (0,), "--scenes", *made, *MADE_TRUTH)
    chart("train", SEEDS, "--scenes", *made, *MADE_TRUTH, "--kept-truths")


def put(work, rows, text, date):
    data = json.loads(DATA.read_text())
    names = [(c["technique"], c["settings"]) for c in data["candidates"]]
    sets, table = {}, listed()
    for folder, views, errors in (("seeds", "views", "errors"), ("train", "made_views", "made_errors")):
        index = {(v["scene"], v["camera"]): i for i, v in enumerate(data[views])}
        known = seed_errors(sorted(work.glob(f"{folder}[0-9]*/results.json")), index)
        for candidate in rows:
            of = names.index(parted(candidate))
            for (scene, _), v in index.items():
                found = known[v, CANDIDATES.index(candidate)]  # an error where a view was not measured
                data[errors][v][of] = rounded(statistics.geometric_mean(found.values()))
                if candidate in table:
                    sets.setdefault(views, {}).setdefault(scene, []).append(len(found))
    least = {views: {scene: min(counts) for scene, counts in of.items()} for views, of in sets.items()}
    usual, made = min(least["views"].values()), min(least["made_views"].values())
    data["errors_again"] = {"rows": text, "date": date, "sets": usual, "more_sets": {scene: n for scene, n in least["views"].items() if n > usual}, "made_sets": made}
    DATA.write_text(compact(data), encoding="utf-8")
    print(DATA, data["errors_again"])


def listed():
    """Of the table: of other candidates fewer sets do."""
    data = Data()
    return [data.names()[c] for c in planner.rows_of_table(data)]


if __name__ == "__main__":
    main()
