"""The part of docs/figures/planner_choosing.py that sets the planner's choices beside path tracing: which takes how long for the same error."""
import copy
import math
import statistics

import numpy as np

from planner_model import at_rest, outcomes, reach

WANTED_TIMES, WANTED_SCENES = 20, 7


def front(points):
    """Of points of the rival those that err least in no more time, the quickest first."""
    line = []
    for p in sorted(points, key=lambda p: p["ms"]):
        if not line or p["all"] < line[-1]["all"]:
            line.append(p)
    return line


def rival_time(points, error):
    """Milliseconds of the rival's line at an error, straight in logarithms: of its end where it never gets so far (it takes longer), None where
    its beginning is better already."""
    line = front(points)
    if error < line[-1]["all"]:
        return line[-1]["ms"]
    for a, b in zip(line, line[1:]):
        if b["all"] <= error <= a["all"]:
            share = math.log(error / a["all"]) / math.log(b["all"] / a["all"])
            return math.exp(math.log(a["ms"]) + share * math.log(b["ms"] / a["ms"]))
    return None


def beside(data, points, v, chosen):
    """(times, candidate) of those of `chosen` whose measured error lies on the rival's line or beyond its end, the most times first."""
    pairs = [((rival_time(points, data.error[v, c]) or 0.0) / data.ms[v, c], c) for c in chosen]
    return sorted((p for p in pairs if p[0] > 0.0), reverse=True)


def asked(data, kept, heldOut, v, points):
    """What the planner chooses, the scene unseen, where it is asked for the error of each point of the rival's line; None: none reaches it."""
    ms, log = (values[v][kept] for values in heldOut)
    found = [reach(ms, log, p["all"]) for p in front(points)]
    return [None if c is None else kept[c] for c in found]


def cell(data, names, points, v, pairs):
    from planner_page import short
    if not pairs:
        return "none on its line | | |"
    times, c = pairs[0]
    more = "> " if data.error[v, c] < front(points)[-1]["all"] else ""
    return f"`{short(names[c])}` | {data.ms[v, c]:.1f} | {data.error[v, c]:.2g} | {more}{times:.1f}"


def table(data, kept, heldOut, found):
    """Lines, and by way of asking the views in which something is WANTED_TIMES as quick; also beside the rival's line of full resolution."""
    from planner_page import view_name
    rivals, names = data.raw["rival"], data.names()
    lines = ["| scene | rival's line: errors | by budget | ms | relMSE | times | by error | ms | relMSE | times |",
             "| --- | --- | --- | ---: | ---: | ---: | --- | ---: | ---: | ---: |"]
    reached = {"budget": [], "error": [], "full": []}
    for view in dict.fromkeys((r["scene"], r["camera"]) for r in rivals):
        v = next(i for i, w in enumerate(data.views) if (w["scene"], w["camera"]) == view)
        points = [r for r in rivals if (r["scene"], r["camera"]) == view]
        answers = asked(data, kept, heldOut, v, points)
        within = [c for c in answers if c is not None]
        budgeted = [f[2] for f in found if f[0] == v and f[5]]
        pairs = {"budget": beside(data, points, v, budgeted), "error": beside(data, points, v, within)}
        each = sorted([times for times, _ in pairs["error"]] + [0.0] * (len(within) - len(pairs["error"])))
        median = f" ({len(within)} of {len(answers)}; {statistics.median(each):.1f})" if each else ""
        name = view_name(data.views[v])
        full = beside(data, [p for p in points if p["resolution"] == "full"], v, within + budgeted)
        for how, found_ in (*pairs.items(), ("full", full)):
            if found_ and found_[0][0] >= WANTED_TIMES:
                reached[how].append(name)
        errors = [p["all"] for p in front(points)]
        lines.append(f"| {name} | {errors[0]:.2g} to {errors[-1]:.2g} | " + " | ".join(cell(data, names, points, v, pairs[how]) for how in pairs) + f"{median} |")
    return lines, reached


def summary(lines, reached):
    count = len(lines) - 2
    tell = lambda some: f"{len(some)} of {count} scenes ({'; '.join(some)})"  # noqa: E731
    return (f"At least {WANTED_TIMES} times as quick, asked for an error, in {tell(reached['error'])}; given a budget in {tell(reached['budget'])}; wanted: {WANTED_SCENES}. Beside the "
            f"rival's line without coarse resolution in {len(reached['full'])} ({'; '.join(reached['full'])}).")


def block(data, kept, heldOut, found):
    if not data.raw["rival"]:
        return []
    lines, reached = table(data, kept, heldOut, found)
    intro = ("**Against path tracing.** The [rival](techniques/rival.md) with two bounces, all that it has, 1 to 8 paths a pixel, filtered, traced at full, half and quarter "
             "resolution: its line is the least error in no more time, of the means of three sample sets. Both it and the planner's choices, the scene unseen, are judged against all bounces: how many "
             "times longer the rival's line takes for the error that what is chosen was measured to have (>: no point of the line is as accurate; then its longest time). By *budget*: 4 to 66 ms; by *error*: "
             "`lwPlan` asked to reach the error of each point of the line. Shown is where the times are most; in brackets, of how many points the planner thinks one within reach, and the times' median over those.")
    return [intro, "", *lines, "", summary(lines, reached), *rest_block(data, kept, heldOut)]


def rest_block(data, kept, heldOut):
    """The same while light and geometry stand still, as far as that is measured."""
    if "rest" not in data.raw:
        return []
    resting = copy.copy(data)
    resting.ms, predicted = at_rest(data, heldOut[0])
    found = outcomes(resting, predicted, heldOut[1], np.arange(len(data.views)), kept)
    lines, reached = table(resting, kept, (predicted, heldOut[1]), found)
    views = {(r["scene"], r["camera"]) for r in data.raw["rival"]}
    mask = np.array([(w["scene"], w["camera"]) in views for w in data.views])[:, None] & ~np.isnan(data.rest) & np.isin(np.arange(len(data.candidates)), kept)
    off = np.abs(predicted[mask] / (data.ms * data.rest)[mask] - 1.0)
    told = data.raw["rest"]
    return ["", f"The rival's tree over the scene and its tables are made before its time is taken, as of a scene that stands still. A host whose light and geometry stand still, and that says so by versions, has `ssvp`'s VPLs, clusters and maps (but those of `sampling=view`) "
            f"[kept](techniques/ssvp.md#frames-at-rest), also while the camera moves, and asks `lwPlan` with `LWPlanDesc::atRest`. The same for it (times above less what is kept, the median of {len(data.raw['rest_shares'])} scenes, {told['date']}: "
            f"{told['frames']} frames with versions told after {told['after']} beside the same without; predicted times are off by {100 * np.median(off):.1f} % of single measured ones at the median):", "",
            *lines, "", "At rest: " + summary(lines, reached)[0].lower() + summary(lines, reached)[1:]]
