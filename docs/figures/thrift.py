#!/usr/bin/env python3
"""Writes the measured part of docs/thrift.md from what `lightwell chart` measured: techniques by a fixed setting, and the same that take no
more than a frame needs.

    docs/figures/thrift.py [--results build/thrift] [--runs 4] [--lightwell build/release/bin/lightwell] [chart options ...]

Charts first where --results holds none of the runs' results.json, with the options that follow (such as --kept-truths); the pairs' points
lie next to each other in time. Of each point the quickest run counts: what else a machine does, or its neighbours on the same memory, only
lengthens times.
"""
import argparse
import math
import pathlib
import sys

from program import ROOT, caller, write_between

sys.path.insert(0, str(ROOT / "samples" / "chart"))
from results import Results, errors, geometric_mean  # noqa: E402

BEGIN, END = "<!-- begin: written by docs/figures/thrift.py -->", "<!-- end -->"
SCENES = ["cornell", "basic", "rooms", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "wooden_staircase"]
# technique, fixed setting, thrifty setting; the first of each technique is its documented default. What is written in a chart's own words:
# only what differs from the defaults, in the order of the parameters.
PAIRS = [("rsm", "", "auto_resolution=1 rsm_versions=on"),
         ("rsm", "", "auto_resolution=1"),
         ("rsm", "", "rsm_versions=on"),
         ("rsm", "", "resolution=half"),
         ("ssvp", "", "auto_resolution=2"),
         ("ssvp", "", "auto_resolution=2 rsm_versions=on"),
         ("ssvp", "", "auto_error=0.1"),
         ("screen_space", "", "auto_error=0.2"),
         ("lpv", "", "rests=on"),
         ("lpv", "", "rests=on rsm_versions=on"),
         ("lpv", "transport=sweep", "transport=sweep rests=on"),
         ("lpv", "transport=sweep", "transport=sweep resolution=half rests=on")]
EQUAL = 1.02  # an error of so much of the fixed setting's is equal


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--results", default=str(ROOT / "build/thrift"))
    parser.add_argument("--runs", type=int, default=4)
    options, chart_options = parser.parse_known_args()
    runs = [run_of(pathlib.Path(options.results) / str(run), options.lightwell, chart_options) for run in range(options.runs)]
    write_between(ROOT / "docs/thrift.md", BEGIN, END, measured(runs))


def run_of(folder, lightwell, chart_options):
    if not (folder / "results.json").exists():
        # A point alone has at least one assignment; the defaults by one of theirs.
        anchors = {"rsm": "vpls=256", "ssvp": "vpls=256", "screen_space": "samples=64", "lpv": "size=32"}
        points = list(dict.fromkeys(f"{t},{(s or anchors[t]).replace(' ', ',')}" for t, fixed, auto in PAIRS for s in (fixed, auto)))
        caller(lightwell)("chart", "--out", folder, "--scenes", *SCENES, "--no-report", *chart_options, "--techniques", *points, shown=True)
    return Results(folder)


def take_quickest(runs, time):
    """Into the first run's points. Errors are all runs': the number of frames, which differs, changes none by a thousandth."""
    for point in runs[0].points:
        twins = [p for run in runs for p in run.points if p["id"] == point["id"] and p["ms"]]
        apart = max((abs(errors(p)["relMSE"] / errors(point)["relMSE"] - 1) for p in twins if errors(p)), default=0.0)
        if apart > 1e-3:
            sys.exit(f"{point['id']}: expected the same error in all runs, got ones that differ by {apart:.1%}")
        if point["ms"]:
            point["ms"][time] = min(p["ms"][time] for p in twins)
    return runs[0]


def measured(runs):
    loads = [load for run in runs for load in run.loads()]
    time = "processor" if "processor" in runs[0].times else "median"
    results = take_quickest(runs, time)
    header = results.header
    lines = [f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]} on {results.device_text()}, "
             f"{header['versions']['threads']} threads; medians of {results.points[0]['frames']} frames at rest, {len(results.views)} views; of {len(runs)} runs the quickest of each point. ms is "
             + ("processor time of all threads divided by their number" if time == "processor" else "the host's clock")
             + f"; load average {min(loads):.1f} to {max(loads):.1f}.", ""]
    rows = [(pair, pair_rows(results, pair, time)) for pair in PAIRS]
    lines += ["| technique | fixed | thrifty | views | ms | thrifty | saved, mean of views | error's ratio, geometric mean | views within 2 % |",
              "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    lines += [summary(pair, found) for pair, found in rows if found]
    for (technique, fixed, auto), found in rows:
        if not found:
            continue
        lines += ["", f"### {technique}: `{auto}`", "",
                  f"Fixed: {f'`{fixed}`' if fixed else 'the defaults'}. relMSE against as many bounces as the technique models; in brackets where "
                  "the truth's noise is more than a tenth of it.", "",
                  "| view | ms | relMSE | thrifty: ms | relMSE | saved | error |", "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
        for view, a, b in found:
            lines.append(f"| {view['scene']}, {view['camera'].replace('suggested_', '')} | {a['ms'][time]:.1f} | {relmse(a)} | {b['ms'][time]:.1f} | "
                         f"{relmse(b)} | {percent(1 - b['ms'][time] / a['ms'][time])} | {percent(ratio(a, b) - 1, '+')} |")
    return lines


def pair_rows(results, pair, time):
    technique, fixed, auto = pair
    rows = []
    for view in results.views:
        points = {p["settings"]: p for p in results.of_view(view) if p["technique"] == technique}
        a, b = points.get(fixed) or points.get("defaults"), points.get(auto)
        if fixed == "" and a is None:
            a = next((p for p in points.values() if "default" in p["label"].split(", ")), None)
        if a and b and a["ms"] and b["ms"] and errors(a) and errors(b):
            rows.append((view, a, b))
    return rows


def ratio(a, b):
    return errors(b)["relMSE"] / errors(a)["relMSE"]


def relmse(point):
    text = f"{errors(point)['relMSE']:.4g}"
    return text if errors(point)["trusted"] else f"({text})"


def percent(share, sign=""):
    return f"{share * 100:{sign}.1f} %"


def summary(pair, found):
    technique, fixed, auto = pair
    time = "processor" if "processor" in found[0][1]["ms"] else "median"
    saved = [1 - b["ms"][time] / a["ms"][time] for _, a, b in found]
    ratios = [ratio(a, b) for _, a, b in found]
    equal = sum(r <= EQUAL for r in ratios)
    return (f"| {technique} | {f'`{fixed}`' if fixed else 'defaults'} | `{auto}` | {len(found)} | {geometric_mean([a['ms'][time] for _, a, _ in found]):.1f} | "
            f"{geometric_mean([b['ms'][time] for _, _, b in found]):.1f} | {percent(sum(saved) / len(saved))} | "
            f"{math.exp(sum(map(math.log, ratios)) / len(ratios)):.3f} | {equal} |")


if __name__ == "__main__":
    main()
