#!/usr/bin/env python3
"""How firm the planner's choices are (docs/planner.md, "How good it is"): the same figures with random errors of the measured times, with times
or errors known beforehand, without made-up scenes, with half of them, and with other constants. From planner_data.json alone; prints, writes nothing.
"""
import numpy as np

import planner
import planner_model
from planner_model import BUDGETS, Data, fit_costs, leave_scenes_out, outcomes, predict_ms

DRAWS = 30


def figures(data, ms, log, kept):
    found = outcomes(data, ms, log, np.arange(len(data.views)), kept)
    ratios = np.array([f[4] for f in found])
    fitting = np.array([f[4] for f in found if f[5]])
    return np.median(ratios), np.quantile(ratios, 0.9), ratios.max(), np.quantile(fitting, 0.9), np.quantile([f[4] for f in found if f[1] == BUDGETS[1]], 0.9)


def tell(what, found):
    print(f"{what:34} median {found[0]:.2f}, 90 % {found[1]:.2f}, worst {found[2]:.2f}; where something fits 90 % {found[3]:.2f}; at {BUDGETS[1]} ms {found[4]:.2f}")


def times_by_scene(data, ms):
    result = np.full_like(ms, np.nan)
    for scene in data.scenes():
        inside, outside = np.where(data.scene != scene)[0], np.where(data.scene == scene)[0]
        result[outside] = predict_ms(data, fit_costs(data, inside), outside)
    return result


def main():
    data = Data()
    kept = planner.rows_of_table(data)
    ms, log = leave_scenes_out(data, kept)
    tell("as it is", figures(data, ms, log, kept))
    tell("errors known", figures(data, ms, data.log, kept))
    tell("times known", figures(data, data.ms, log, kept))
    measured, random = data.ms, np.random.default_rng(1)
    for off in (0.01, 0.05):
        found = []
        for _ in range(DRAWS):
            data.ms = measured * np.exp(random.normal(0.0, off, measured.shape))
            found.append(figures(data, times_by_scene(data, ms), log, kept))
        found = np.array(found)
        tell(f"times {off:.0%} off, medians of {DRAWS}", np.median(found, axis=0))
        print(f"{'':34} 90 % within 1.6 in {(found[:, 1] <= 1.6).sum()} draws, worst within 2.5 in {(found[:, 2] <= 2.5).sum()}")
    data.ms = measured
    made = data.madeLog, data.madeProbes
    for what, part in (("no made-up scenes", slice(0, 0)), ("every second made-up scene", slice(0, None, 2)), ("the others", slice(1, None, 2))):
        data.madeLog, data.madeProbes = made[0][part], made[1][part]
        tell(what, figures(data, *leave_scenes_out(data, kept), kept))
    data.madeLog, data.madeProbes = made
    for weight in (0.5, 2.0):
        planner_model.MADE = weight
        tell(f"made-up scenes weigh {weight:g}", figures(data, *leave_scenes_out(data, kept), kept))
    planner_model.MADE = 1.0
    for same in (1.0, 1.02, 1.1, 1.15, 1.2):
        planner_model.SAME_TIME = same
        tell(f"where nothing fits {same - 1:.0%} longer", figures(data, ms, log, kept))


if __name__ == "__main__":
    main()
