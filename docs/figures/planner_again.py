#!/usr/bin/env python3
"""Measures errors of the planner's candidates once more, of all or of some, and puts them into planner_data.json; times stay.

    docs/figures/planner_again.py [--rows visibility=careful] [--lightwell build/release/bin/lightwell] [--work build/planner_again] [--date 2026-11-30] [--put]

--rows: a setting that candidates have, after a change of their light; `table`: those of the table whose VPLs are drawn; without: all candidates, and path tracing. In all views and made-up scenes, of as many sample sets as
planner_measure.py takes. --put: measures nothing, and takes in what lies in folders of --work (called as planner_measure.py's are, with anything behind the set's number). What has been
measured is kept: hours where truths are not cached. Then docs/figures/planner.py fits anew. Of what `planner.py --collect` takes in nothing changes: it would bring the old errors back.

Errors by truths of other noise are not comparable: some rows alone are refused where, in a real view, it is not the noise that the others' errors were measured with.
"""
import json
import pathlib
import statistics
import sys

import planner
import planner_scenes
from planner_candidates import CANDIDATES, is_drawn, parted
from planner_measure import SCENES, SIZE, TRUTH, chart_errors, charter, compact, is_taught, noiseless, of_set, read_points, rounded, seed_errors
from planner_model import DATA, Data
from program import caller, read_work

TABLE = "table"  # of --rows
SAME_NOISE = 1.25  # of a view's truth: more off, and a row's error tells of the truth beside others'


def main():
    options = read_work(__doc__, "planner_again", lambda parser: parser.add_argument("--rows", default=""))
    rows = rows_of_table() if options.rows == TABLE else [c for c in CANDIDATES if not options.rows or options.rows in c.split()]
    if not rows:
        sys.exit(f"--rows: expected a setting of a candidate or '{TABLE}', got '{options.rows}'")
    if not options.put:
        measure(options.lightwell, options.work, rows)
    put(options.work, rows, options.rows, options.date)


def measure(program, work, rows):
    chart = charter(caller(program), work)
    chart("seeds0", of_set(rows, 0), SIZE, 1, "--scenes", *SCENES, *TRUTH)
    chart_errors(chart, rows, planner_scenes.write(work / "made"))


# ------------------------------------------------------------------------------------ to the data

def put(work, rows, setting, date):
    data = json.loads(DATA.read_text())
    files = sorted(work.glob("seeds[0-9]*/results.json"))
    renew_noise(data, files, isAll=not setting)
    counts = put_errors(data, "views", "errors", files, rows, isWhole=True)
    made = put_errors(data, "made_views", "made_errors", sorted(work.glob("train[0-9]*/results.json")), [c for c in rows if is_taught(c)], isWhole=False)
    if not setting:
        put_rivals(data, work)
    DATA.write_text(compact(data), encoding="utf-8")
    drawn = [n for c, counted in made.items() if is_drawn(c) for n in counted]
    told = {"date": date, "rows": setting, **sets_of(data, counts, rows), "made_rows": len(made), "made_sets": sorted({min(drawn, default=0), max(drawn, default=0)})}
    data["errors_again"] = ([] if not setting else data.get("errors_again", [])) + [told]
    DATA.write_text(compact(data), encoding="utf-8")
    print(DATA, told)


def renew_noise(data, files, isAll):
    """Of each view's truth. Where only some rows' errors come, the others' keep theirs: it must be the same."""
    found = {}
    for file in files:
        for p in read_points(file.parent)[1]:
            found.setdefault((pathlib.Path(p["scene"]).stem, p["camera"]), []).append(p["errors"]["all"]["noise"])
    for view in data["views"]:
        noises = found.get((view["scene"], view["camera"]))
        if not noises:
            sys.exit(f"{view['scene']}, {view['camera']}: expected points of it below --work, got none")
        if max(noises) > SAME_NOISE * min(noises):
            sys.exit(f"{view['scene']}, {view['camera']}: expected the same truth of all points, got noise from {min(noises):.3g} to {max(noises):.3g}")
        if isAll:
            view["noise"] = rounded(min(noises), 3)
        elif not 1 / SAME_NOISE < min(noises) / view["noise"] < SAME_NOISE:
            sys.exit(f"{view['scene']}, {view['camera']}: expected a truth's noise of {view['noise']:.3g}, which other rows were measured with, got {min(noises):.3g}")


def put_errors(data, views, errors, files, rows, isWhole):
    """Numbers of sample sets of each view, by the row; isWhole: all rows must be there in every view."""
    names = [(c["technique"], c["settings"]) for c in data["candidates"]]
    index = {(v["scene"], v["camera"]): i for i, v in enumerate(data[views])}
    known = seed_errors(files, index)
    counts = {}
    for candidate in rows:
        of = names.index(parted(candidate))
        found = [known.get((v, CANDIDATES.index(candidate)), {}) for v in index.values()]
        if not all(found):
            if isWhole or any(found):
                sys.exit(f"{candidate}: expected errors of all {views}, got them of {sum(map(bool, found))} of {len(found)}")
            continue
        for v, sets in zip(index.values(), found):
            data[errors][v][of] = rounded(statistics.geometric_mean(sets.values()))
        counts[candidate] = [len(sets) for sets in found]
    return counts


def put_rivals(data, work):
    """Errors alone: times are of the sitting of the other times."""
    sets = {}
    for file in sorted(work.glob("rival[0-9]*/results.json")):
        for p in read_points(file.parent)[1]:
            sets.setdefault((p["scene"], p["camera"], *(p["parameters"][key] for key in ("bounces", "spp", "resolution"))), []).append(noiseless(p["errors"]["all"]))
    for row in data["rival"]:
        found = sets.get((row["scene"], row["camera"], row["bounces"], row["spp"], row["resolution"]))
        if not found:
            sys.exit(f"path tracing in {row['scene']}, spp={row['spp']} {row['resolution']}: expected points of it below --work, got none")
        row.update(all=rounded(statistics.geometric_mean(found)), sets=len(found))


def rows_of_table():
    """Whose VPLs are drawn. The table is chosen by errors: of what is measured that is taken in, it may be another."""
    data = Data()
    return [c for c in (data.names()[k] for k in planner.rows_of_table(data)) if is_drawn(c)]


def sets_of(data, counts, rows):
    """Of the rows of the table, which is chosen by these very errors, where VPLs are drawn; of other rows fewer sets do."""
    table = [c for c in rows_of_table() if c in rows]
    least = {}
    for v, view in enumerate(data["views"]):
        least.setdefault(view["scene"], []).append(min(counts[c][v] for c in table) if table else 0)
    least = {scene: min(of) for scene, of in least.items()}
    usual = min(least.values())
    return {"sets": usual, "more_sets": {scene: n for scene, n in least.items() if n > usual}}


if __name__ == "__main__":
    main()
