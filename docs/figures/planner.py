#!/usr/bin/env python3
"""Fits the planner to planner_data.json: writes src/planner/plan_tables.h, the marked blocks of docs/planner.md, docs/choosing.md,
docs/techniques/ssvp_visibility.md and docs/accuracy.md, their pictures, and what tests hold the C++ to.

    docs/figures/planner.py                                    from planner_data.json alone: seconds
    docs/figures/planner.py --measure [--lightwell PROGRAM]    measures first: hours where truths are not cached
    docs/figures/planner.py --collect --work DIR               takes what was measured below DIR
    docs/figures/planner.py --maps [--lightwell PROGRAM]       measures what maps take to draw, and nothing else

The candidates are in planner_candidates.py, the models in planner_model.py, the measuring in planner_measure.py (planner_again.py, planner_rest.py) with its made-up scenes in planner_scenes.py,
the pages in planner_page.py, planner_choosing.py and planner_rival.py.
"""
import argparse
import datetime
import pathlib

import numpy as np

import planner_measure
import planner_page
from planner_candidates import barred
from planner_model import BUDGETS, FLOORS, LIMIT, PROBES, Data, ErrorModel, choose, fit_costs, fit_rest, leave_scenes_out, light_of, needs_light, predict_ms, strengths

ROOT = pathlib.Path(__file__).resolve().parents[2]
NEAR = 1.05  # of the least error that a view has in no more time: nearer than this is on the front, or as good
SCENES = 2  # that a row of the table is so near the front in: one scene alone may be its luck
NEEDS = {"rsms": 1, "radiance": 2, "camera": 4, "geometry": 8, "views": 64}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/planner")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--collect", action="store_true")
    parser.add_argument("--maps", action="store_true")
    parser.add_argument("--date", default=datetime.date.today().isoformat())
    options = parser.parse_args()
    if options.measure:
        options.work.mkdir(parents=True, exist_ok=True)
        planner_measure.measure(options.lightwell, options.work)
    if options.measure or options.collect:
        planner_measure.collect(options.work, options.date)
    if options.maps:
        planner_measure.put_maps(options.lightwell)
    data = Data()
    kept = rows_of_table(data)
    heldOut = leave_scenes_out(data, kept)
    everything = np.arange(len(data.views))
    ridges = strengths(data, everything, kept)
    model, costs = ErrorModel(data, everything, kept, *ridges), fit_costs(data, everything)
    sigma = spread(data, heldOut[1])
    check_rest(data, kept)
    write_tables(data, kept, model, costs, fit_rest(data, costs, everything), sigma)
    write_values(data, kept, model, costs)
    planner_page.write(data, kept, heldOut, ridges, sigma, model, costs)


def check_rest(data, kept):
    """A row of the table whose times at rest nobody measured would be taken for one that keeps nothing."""
    known = {light_of(data.candidates[c]) for c in np.where((~np.isnan(data.rest)).any(axis=0))[0]}
    for c in kept:
        if needs_light(*data.candidates[c]) and light_of(data.candidates[c]) not in known:
            raise SystemExit(f"{data.names()[c]}: expected its times at rest, got none: measure them with docs/figures/planner_rest.py")


def rows_of_table(data):
    """What is near the front in two scenes or more. Without maps of 256 x 256: for 5 % less error at rest they are four times as dear where lights
    move, and single sample sets of theirs rule what is chosen. Nor hard maps where strict ones of the same settings are measured, which for a
    twentieth more time err by up to a fifth more where all is bright, and by half and less where light comes through openings. Nor what is not
    known of made-up scenes."""
    names = data.names()
    able = [c for c in range(len(names)) if names[c] not in barred(names)]
    known = [c for c in able if np.isfinite(data.madeLog[:, c]).all()]
    for c in sorted(near_front(data, able, SCENES) - set(known)):
        print(f"not in the table, as made-up scenes lack it: {names[c]}")
    return np.array(sorted(near_front(data, known, SCENES)))


def near_front(data, able, scenes):
    """Those of `able` that are near the front of errors and times in some view of so many scenes, among what asks for no more inputs: a frame without
    light maps or triangles has a front of its own."""
    near = set()
    needs = [needs_of(*c) for c in data.candidates]
    for have in (64 + 15, 15, 1 + 2 + 4, 9, 1, 2 + 4, 4):
        some = [c for c in able if needs[c] & ~have == 0]
        for c in some:
            quick = [[k for k in some if ms[k] <= ms[c] * 1.02] for ms in data.ms]
            views = [v for v in range(len(data.views)) if data.error[v, c] <= NEAR * data.error[v, quick[v]].min()]
            if len(set(data.scene[views])) >= scenes:
                near.add(c)
    return near


def needs_of(technique, settings):
    if technique == "fallback":
        parts = dict(s.split("=") for s in settings.split())
        first, second = parts["first"], parts["second"]
        return needs_of(first, "") | needs_of(second, f"visibility={parts.get('second.visibility', '')}")
    light, shape = NEEDS["rsms"], NEEDS["geometry"]
    if technique == "rsm":
        return light | (shape if "voxel" in settings else 0)
    if technique == "ssvp":
        return light | shape | (NEEDS["views"] if "sampling=view" in settings else 0)
    return {"lpv": light | shape, "cone_tracing": light | shape, "ao": NEEDS["radiance"] | NEEDS["camera"],
            "screen_space": NEEDS["radiance"] | NEEDS["camera"], "horizon": NEEDS["radiance"] | NEEDS["camera"]}[technique]


def maps_of(technique, settings):
    """Maps of 128 x 128 texels that a frame draws whose lights have moved: each bounce but the last is drawn out of maps, and light is shadowed
    by maps of the first bounce and, unless shadowed_bounces=1, of the second."""
    if technique == "fallback":
        parts = [s for s in settings.split() if s.startswith("second.")]
        return maps_of(dict(s.split("=") for s in settings.split())["second"], " ".join(s[7:] for s in parts))
    if technique != "ssvp":
        return 0.0
    value = {"clusters": 8, "map_size": 128, "bounces": 2, "shadowed_bounces": 2}
    value |= {k: int(v) for k, v in (s.split("=") for s in settings.split()) if k in value}
    sets = max(value["bounces"] - 1, min(value["bounces"], value["shadowed_bounces"]))
    return sets * value["clusters"] * (value["map_size"] / 128) ** 2


def fit_maps(data):
    """ms of a map, fixed and by a million triangles; neither is negative. Scenes lie a decade apart: by what is off relative to what it is."""
    measured = data.raw["maps"]
    ms = np.array([m["ms"] / m["maps"] for m in measured])
    columns = np.array([[1.0, m["triangles"] * 1e-6] for m in measured])
    fit = np.linalg.lstsq(columns / ms[:, None], np.ones(len(ms)), rcond=None)[0]
    return fit if fit.min() >= 0.0 else np.array([ms.mean(), 0.0])


def spread(data, log):
    """Standard deviation of what predictions of unseen scenes were off by: a candidate's own, drawn half towards that of all."""
    off = (log - data.log) ** 2
    return np.sqrt(0.5 * off.mean(axis=0) + 0.5 * np.nanmean(off))


def numbers(values, digits=4):
    return ", ".join(f"{float(v):.{digits}g}" for v in values)


def write_tables(data, kept, model, costs, rest, sigma):
    rates = data.raw["rates"]
    facing, coverage = data.probes[:, PROBES.index("facing")].mean(), data.coverage.mean()
    order = sorted(kept, key=lambda c: np.median(data.ms[:, c]))
    lines = ["// Written by docs/figures/planner.py; see plan_row.h for what it means.", "#pragma once", "", '#include "planner/plan_row.h"', "",
             "namespace lightwell {", "",
             f'constexpr PlanReference kPlanReference = {{"{data.raw["device"]}", {rates["multiply_add_gflops"]:.4g}, {rates["bandwidth_GBps"]:.4g}, '
             f'{rates["launch_us"]:.3g}, {facing:.3g}, {coverage:.3g}}};', "",
             f"constexpr PlanMaps kPlanMaps = {{{numbers(fit_maps(data))}}};", "", "constexpr PlanProbeScale kPlanScales[kPlanProbes] = {"]
    for k, name in enumerate(PROBES):
        lines.append(f'    {{"{name}", {FLOORS[k]:g}, {model.mean[k]:.4f}, {model.deviation[k]:.4f}, {-LIMIT}, {LIMIT}}},')
    lines += ["};", "", "constexpr PlanRow kPlanRows[] = {"]
    for c in order:
        technique, settings = data.candidates[c]
        launches = data.raw["candidates"][c]["launches"]
        lines.append(f'    {{"{technique}", "{settings}", {needs_of(technique, settings)}, {launches:g}, {maps_of(technique, settings):g}, {{{numbers(costs[c])}}}, {{{numbers(rest[c])}}}, {model.means[c]:.4f},\n'
                     f"     {{{numbers(model.slopes[:, c])}}}, {sigma[c]:.4f}}},")
    lines += ["};", "", "}  // namespace lightwell", ""]
    path = ROOT / "src/planner/plan_tables.h"
    path.write_text("\n".join(lines), encoding="utf-8")
    print(path)


def write_values(data, kept, model, costs):
    """Predictions and choices for views as measured, by this script's arithmetic: tests/unit/planner_values_test.cpp."""
    names = data.names()
    lines = ["// Written by docs/figures/planner.py: what its own arithmetic predicts and chooses, from the unrounded fit.", "#pragma once", "",
             "struct PlannerValue {", "    float probes[8], coverage;", "    double triangles;", "    const char* row;  // technique and settings",
             "    double milliseconds, error;", "    const char* chosen[5];  // of budgets of 4, 8, 16, 33, 66 ms", "};", "",
             "constexpr PlannerValue kPlannerValues[] = {"]
    for v in range(0, len(data.views), 3):
        ms = predict_ms(data, costs, np.array([v]))[0][kept]
        log = model.predict(data.probes[[v]])[0][kept]
        some = kept[v % len(kept)]
        at = list(kept).index(some)
        chosen = ", ".join(f'"{names[kept[choose(ms, log, budget)]]}"' for budget in BUDGETS)
        probes = ", ".join(f"{p:.9g}f" if "." in f"{p:.9g}" or "e" in f"{p:.9g}" else f"{p:.1f}f" for p in data.probes[v])
        lines.append(f'    {{{{{probes}}}, {data.coverage[v]:.6f}f, {data.views[v]["triangles"]}.0, "{names[some]}", {ms[at]:.6g}, {10 ** log[at]:.6g},\n     {{{chosen}}}}},')
    lines += ["};", ""]
    path = ROOT / "tests/reference/planner_values.h"
    path.write_text("\n".join(lines), encoding="utf-8")
    print(path)


if __name__ == "__main__":
    main()
