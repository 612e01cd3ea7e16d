"""The part of docs/figures/planner_choosing.py that sets the planner's choices beside path tracing: which takes how long for the same error."""
import math
import statistics

from planner_model import reach

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


def block(data, kept, heldOut, found):
    from planner_page import view_name
    rivals, names = data.raw["rival"], data.names()
    if not rivals:
        return []
    lines = ["**Against path tracing.** The [rival](techniques/rival.md) with two bounces, all that it has, 1 to 8 paths a pixel, filtered, traced at full, half and quarter "
             "resolution: its line is the least error in no more time, of the means of three sample sets. Both it and the planner's choices, the scene unseen, are judged against all bounces: how many "
             "times longer the rival's line takes for the error that what is chosen was measured to have (>: no point of the line is as accurate; then its longest time). By *budget*: 4 to 66 ms; by *error*: "
             "`lwPlan` asked to reach the error of each point of the line. Shown is where the times are most; in brackets, of how many points the planner thinks one within reach, and the times' median over those.", "",
             "| scene | rival's line: errors | by budget | ms | relMSE | times | by error | ms | relMSE | times |",
             "| --- | --- | --- | ---: | ---: | ---: | --- | ---: | ---: | ---: |"]
    reached = {"budget": [], "error": []}
    fullOnly = []
    for view in dict.fromkeys((r["scene"], r["camera"]) for r in rivals):
        v = next(i for i, w in enumerate(data.views) if (w["scene"], w["camera"]) == view)
        points = [r for r in rivals if (r["scene"], r["camera"]) == view]
        answers = asked(data, kept, heldOut, v, points)
        within = [c for c in answers if c is not None]
        pairs = {"budget": beside(data, points, v, [f[2] for f in found if f[0] == v and f[5]]), "error": beside(data, points, v, within)}
        each = sorted([times for times, _ in pairs["error"]] + [0.0] * (len(within) - len(pairs["error"])))
        median = f" ({len(within)} of {len(answers)}; {statistics.median(each):.1f})" if each else ""
        name = view_name(data.views[v])
        for how, found_ in pairs.items():
            if found_ and found_[0][0] >= WANTED_TIMES:
                reached[how].append(name)
        full = beside(data, [p for p in points if p["resolution"] == "full"], v, within + [f[2] for f in found if f[0] == v and f[5]])
        if full and full[0][0] >= WANTED_TIMES:
            fullOnly.append(name)
        errors = [p["all"] for p in front(points)]
        lines.append(f"| {name} | {errors[0]:.2g} to {errors[-1]:.2g} | " + " | ".join(cell(data, names, points, v, pairs[how]) for how in pairs) + f"{median} |")
    count = len(lines) - 4
    tell = lambda some: f"{len(some)} of {count} scenes ({'; '.join(some)})"  # noqa: E731
    return lines + ["", f"At least {WANTED_TIMES} times as quick, asked for an error, in {tell(reached['error'])}; given a budget in {tell(reached['budget'])}; wanted: {WANTED_SCENES}. Beside the rival's line "
                    f"without coarse resolution in {len(fullOnly)} ({'; '.join(fullOnly)})."]
