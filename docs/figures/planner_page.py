"""What docs/figures/planner.py writes into pages: tables and pictures of the planner's fit, of choosing, and of errors."""
import math
import pathlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from planner_model import BUDGETS, Data, outcomes  # noqa: E402,F401
from program import write_between  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- begin: written by docs/figures/planner.py -->", "<!-- end: planner -->"
COLOURS = {"rsm": "#d98b2b", "ssvp": "#1f6fb4", "lpv": "#3f9b57", "cone_tracing": "#8a5bb0", "screen_space": "#c2464a", "horizon": "#7d6a55",
           "ao": "#999999", "fallback": "#3bb0b8"}
# What a host may have, and which bits of PlanNeeds that is.
INPUTS = [("RSMs, triangles, G-buffer with direct light", 15), ("RSMs and G-buffer, no triangles", 7), ("G-buffer with direct light alone", 6),
          ("G-buffer without light", 4)]
WANTED_TIMES = 20
DRAWN_BUDGETS = np.geomspace(4, 100, 200)


def short(name):
    return name.replace("resolution=half", "half").replace("resolution=quarter", "quarter").replace("shadowed_bounces", "shadowed")


def view_name(view):
    camera = view["camera"].replace("suggested_", "")
    return f"{view['scene']}, {camera}"


def write(data, kept, heldOut, strength, sigma, model, costs):
    from planner import needs_of
    needs = np.array([needs_of(*c) for c in data.candidates])
    ms, log = heldOut
    everything = np.arange(len(data.views))
    found = outcomes(data, ms, log, everything, kept)
    draw_predicted(data, kept, ms, log)
    draw_choosing(data, needs)
    write_between(ROOT / "docs/planner.md", BEGIN, END, fit_block(data, kept, ms, log, found, strength, sigma))
    write_between(ROOT / "docs/choosing.md", BEGIN, END, choosing_block(data, kept, needs, found))
    write_between(ROOT / "docs/choosing.md", "<!-- begin: thrift, written by docs/figures/planner.py -->", "<!-- end: thrift -->", thrift_block(data))
    write_between(ROOT / "docs/accuracy.md", BEGIN, END, accuracy_block(data, kept))


# --------------------------------------------------------------------------------- docs/planner.md

def summary(ratios):
    ratios = np.asarray(ratios)
    return [f"{np.median(ratios):.2f}", f"{np.quantile(ratios, 0.9):.2f}", f"{ratios.max():.3g}"]


def fixed_policies(data):
    """Choices that look at no frame: for each budget the configuration that would do best on the mean logarithm; and ssvp, or rsm, whatever
    the budget."""
    names = data.names()
    everything = range(len(data.views))

    def ratios(pick):
        result = []
        for budget in BUDGETS:
            for v in everything:
                fits = np.where(data.ms[v] <= budget)[0]
                best = fits[np.argmin(data.log[v, fits])] if len(fits) else int(np.argmin(data.ms[v]))
                result.append(10 ** (data.log[v, pick(budget, v)] - data.log[v, best]))
        return result

    def of_budget(budget, v):
        others = data.scene != data.scene[v]
        affordable = np.where(np.median(data.ms[others], axis=0) <= budget)[0]
        if not len(affordable):
            return int(np.argmin(np.median(data.ms[others], axis=0)))
        return int(affordable[np.argmin(data.log[others][:, affordable].mean(axis=0))])

    return [("one configuration for each budget, the best of the other scenes", ratios(of_budget), of_budget),
            ("always ssvp's defaults, late or not", ratios(lambda b, v: names.index("ssvp")), lambda b, v: names.index("ssvp")),
            ("always rsm's defaults, late or not", ratios(lambda b, v: names.index("rsm")), lambda b, v: names.index("rsm"))]


def late_share(data, picks):
    late = [data.ms[v, c] > 1.1 * b for v, b, c in picks if (data.ms[v] <= b).any()]
    return f"{100 * np.mean(late):.0f} %"


def fit_block(data, kept, ms, log, found, strength, sigma):
    raw = data.raw
    off = np.abs(ms[:, kept] / data.ms[:, kept] - 1.0)
    byScene = log[:, kept] - data.log[:, kept]
    twice = np.mean(np.abs(byScene) <= math.log10(2))
    said = np.mean([math.erf(math.log10(2) / (s * math.sqrt(2))) for s in sigma[kept]])
    (rank, ridge), ofView = strength
    lines = [f"Measured {raw['date']} at {raw['size'][0]}x{raw['size'][1]} on {raw['device']}, {raw['threads']} threads of one shared machine: time is processor time of "
             f"all threads over their number, times {raw['clock_over_processor']:.3f}, what the clock showed beyond it where nothing else ran. "
             f"{len(data.candidates)} configurations in {len(data.views)} views of {len(set(v['scene'] for v in data.views))} scenes; {len(kept)} of them, within 5 % of a front "
             "somewhere, are the table. Errors are against all bounces, at one pixel of each "
             f"{raw['judged_block']} x {raw['judged_block']}; the truth's own noise ({min(v['noise'] for v in data.views):.1g} to {max(v['noise'] for v in data.views):.1g}) is taken off.", "",
             "Everything below is *leave one scene out*: each view is predicted by models that were fitted without its scene (the two Cornell "
             "boxes count as one), with the strengths of shrinking chosen within the scenes that are left. The fit to all: "
             + (f"slopes of rank {rank}, ridge {ridge:g}" if math.isfinite(ridge) else "no slopes that tell candidates apart")
             + (f", ridge {ofView:g} of what is alike for all." if math.isfinite(ofView) else ", none that is alike for all."), "",
             "![Predicted against measured, scenes left out](images/planner_predicted.png)", "",
             f"**Time**: off by {100 * np.median(off):.1f} % at the median, {100 * np.quantile(off, 0.9):.0f} % at the ninth decile (wanted: 15 % at the median). "
             f"**Error**: within a factor of two in {100 * twice:.0f} % of all predictions (the confidences say {100 * said:.0f} %). Most of what is off is alike for all "
             "candidates of a view, and does not change what is chosen.", "",
             "**Choice**: the error of what is chosen over the error of the best of all measured configurations that fit the budget in truth "
             "(where none fits, of the quickest).", "",
             "| policy | median | 90 % | worst | over the budget by a tenth |", "| --- | ---: | ---: | ---: | ---: |"]
    lines.append("| wanted | 1.25 | 1.6 | 2.5 | |")
    lines.append("| " + " | ".join(["the planner", *summary([f[4] for f in found]), late_share(data, [(f[0], f[1], f[2]) for f in found])]) + " |")
    real = [f for f in found if f[5]]
    lines.append("| " + " | ".join(["the same, only where something fits", *summary([f[4] for f in real]), late_share(data, [(f[0], f[1], f[2]) for f in real])]) + " |")
    for name, ratios, pick in fixed_policies(data):
        picks = [(v, b, pick(b, v)) for b in BUDGETS for v in range(len(data.views))]
        lines.append("| " + " | ".join([name, *summary(ratios), late_share(data, picks)]) + " |")
    lines += ["", "| budget | views where something fits | median | 90 % | worst |", "| ---: | ---: | ---: | ---: | ---: |"]
    for budget in BUDGETS:
        some = [f for f in found if f[1] == budget]
        lines.append(f"| {budget} ms | {sum(f[5] for f in some)} of {len(some)} | " + " | ".join(summary([f[4] for f in some])) + " |")
    lines += ["", "Where it is wrong by more than 1.6:", "", "| view | budget | chosen | relMSE | best | relMSE | ratio |", "| --- | ---: | --- | ---: | --- | ---: | ---: |"]
    names = data.names()
    for v, budget, c, best, ratio, _ in sorted(found, key=lambda f: -f[4]):
        if ratio > 1.6:
            lines.append(f"| {view_name(data.views[v])} | {budget} ms | `{short(names[c])}` | {data.error[v, c]:.3g} | `{short(names[best])}` | {data.error[v, best]:.3g} | {ratio:.3g} |")
    return lines


def draw_predicted(data, kept, ms, log):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 4.3), dpi=100)
    for technique in dict.fromkeys(data.candidates[c][0] for c in kept):
        of = [c for c in kept if data.candidates[c][0] == technique]
        style = dict(s=9, color=COLOURS[technique], alpha=0.6, linewidths=0, label=technique)
        left.scatter(data.ms[:, of], ms[:, of], **style)
        right.scatter(data.error[:, of], 10 ** log[:, of], **style)
    for axes, factor, what in ((left, 1.15, "ms"), (right, 2.0, "relMSE, all bounces")):
        axes.set_xscale("log"), axes.set_yscale("log")
        low, high = axes.get_xlim()
        line = np.array([low, high])
        axes.plot(line, line, color="black", linewidth=0.8)
        axes.fill_between(line, line / factor, line * factor, color="black", alpha=0.08, linewidth=0)
        axes.set_xlim(low, high), axes.set_ylim(low, high)
        axes.set_xlabel(f"measured {what}"), axes.set_ylabel(f"predicted {what}")
    left.set_title("time (grey: 15 %)", fontsize=10), right.set_title("error (grey: a factor of two)", fontsize=10)
    left.legend(fontsize=7, loc="upper left", markerscale=1.6)
    save(figure, "planner_predicted.png")


def save(figure, name):
    figure.tight_layout()
    path = ROOT / "docs/images" / name
    figure.savefig(path)
    plt.close(figure)
    print(path)


# -------------------------------------------------------------------------------- docs/choosing.md

def best_by_budget(data, able, budget, rows=None):
    """Of candidates that at the median keep the budget: the least geometric mean of errors."""
    rows = np.arange(len(data.views)) if rows is None else rows
    affordable = [c for c in able if np.median(data.ms[rows, c]) <= budget]
    return min(affordable, key=lambda c: data.log[rows, c].mean()) if affordable else None


def draw_choosing(data, needs):
    figure, every = plt.subplots(len(INPUTS), 1, figsize=(9.2, 1.15 * len(INPUTS) + 0.8), dpi=100, sharex=True)
    names = data.names()
    for axes, (title, have) in zip(every, INPUTS):
        able = [c for c in range(len(needs)) if needs[c] & ~have == 0]
        picks = [best_by_budget(data, able, b) for b in DRAWN_BUDGETS]
        start = 0
        for i in range(1, len(picks) + 1):
            if i < len(picks) and picks[i] == picks[start]:
                continue
            low, high = DRAWN_BUDGETS[start], DRAWN_BUDGETS[min(i, len(picks) - 1)]
            c = picks[start]
            axes.axvspan(low, high, color="#eeeeee" if c is None else COLOURS[data.candidates[c][0]], alpha=0.35 if c is not None else 1, linewidth=0)
            axes.axvline(low, color="white", linewidth=1.5)
            wide = math.log(high / low)
            if wide > 0.12:
                text = "nothing" if c is None else label_of(names[c], 10 ** data.log[:, c].mean())
                axes.text(math.sqrt(low * high), 0.5, text, ha="center", va="center", fontsize=6.2 if wide > 0.3 else 5.2, rotation=0 if wide > 0.3 else 90)
            start = i
        axes.set_yticks([]), axes.set_ylim(0, 1)
        axes.set_title(title, fontsize=8.5, loc="left", pad=2)
        axes.set_xscale("log"), axes.set_xlim(DRAWN_BUDGETS[0], DRAWN_BUDGETS[-1])
    every[-1].set_xticks([4, 8, 16, 33, 66, 100], ["4", "8", "16", "33", "66", "100"])
    every[-1].minorticks_off()
    every[-1].set_xlabel("budget, ms at 1280x720 on two CPU cores; number: geometric mean of relMSE over all views")
    save(figure, "choosing.png")


def label_of(name, error):
    technique, _, settings = short(name).partition(" ")
    words = settings.split()
    lines = [technique] + [" ".join(words[i:i + 2]) for i in range(0, len(words), 2)]
    return "\n".join(lines + [f"{error:.2g}"])


def choosing_block(data, kept, needs, found):
    names = data.names()
    lines = [f"Measured {data.raw['date']} at {data.raw['size'][0]}x{data.raw['size'][1]} on {data.raw['device']}, {data.raw['threads']} threads; see "
             "[the planner](planner.md#how-good-it-is) for how. relMSE against all bounces, geometric mean over the views; in brackets the least and the "
             "largest of them.", "", "![What to take for which inputs and budget](images/choosing.png)", "",
             "| what the host has | " + " | ".join(f"{b} ms" for b in BUDGETS) + " |", "| --- |" + " --- |" * len(BUDGETS)]
    for title, have in INPUTS:
        able = [c for c in range(len(needs)) if needs[c] & ~have == 0]
        cells = []
        for budget in BUDGETS:
            c = best_by_budget(data, able, budget)
            if c is None:
                cells.append("nothing")
            else:
                cells.append(f"`{short(names[c])}`: {10 ** data.log[:, c].mean():.2g} ({data.error[:, c].min():.2g} to {data.error[:, c].max():.2g})")
        lines.append(f"| {title} | " + " | ".join(cells) + " |")
    lines += ["", "View by view, what the planner chooses that did not know the scene: error, and in brackets that of the best that fits:", "",
              "| view | " + " | ".join(f"{b} ms" for b in BUDGETS) + " |", "| --- |" + " --- |" * len(BUDGETS)]
    for v, view in enumerate(data.views):
        cells = []
        for budget in BUDGETS:
            f = next(f for f in found if f[0] == v and f[1] == budget)
            cells.append(f"`{short(names[f[2]])}` {data.error[v, f[2]]:.2g} ({data.error[v, f[3]]:.2g})" if f[5] else "nothing fits")
        lines.append(f"| {view_name(view)} | " + " | ".join(cells) + " |")
    return lines + [""] + rival_lines(data, found)


STEPS = [("bounces 2 to 4", "ssvp clusters=16 resolution=half", "ssvp clusters=16 bounces=4 resolution=half"),
         ("clusters 8 to 16", "ssvp bounces=4 resolution=half", "ssvp clusters=16 bounces=4 resolution=half"),
         ("clusters 16 to 32", "ssvp clusters=16 bounces=4 resolution=half", "ssvp clusters=32 bounces=4 resolution=half"),
         ("VPLs 256 to 512", "ssvp clusters=16 bounces=4 resolution=half", "ssvp vpls=512 clusters=16 bounces=4 resolution=half"),
         ("VPLs 256 to 1,024", "ssvp clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half"),
         ("clusters 32 to 64", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"),
         ("interleave 4 to 8", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 interleave=8 resolution=half"),
         ("later bounces' light unshadowed", "ssvp clusters=16 bounces=4 resolution=half", "ssvp clusters=16 bounces=4 shadowed_bounces=1 resolution=half"),
         ("half to full resolution", "ssvp clusters=16 bounces=4 resolution=half", "ssvp clusters=16 bounces=4")]


def thrift_block(data):
    names = data.names()
    lines = ["| step | from | time | error | views where the error falls |", "| --- | --- | ---: | ---: | ---: |"]
    for title, before, after in STEPS:
        a, b = names.index(before), names.index(after)
        change = data.log[:, b] - data.log[:, a]
        lines.append(f"| {title} | `{short(before)}` | x {np.median(data.ms[:, b] / data.ms[:, a]):.2f} | x {10 ** change.mean():.2f} | "
                     f"{(change < 0).sum()} of {len(change)} |")
    return lines


def rival_time(points, error):
    """Milliseconds of the rival's line at an error, straight in logarithms; None beyond its ends."""
    front = []
    for p in sorted(points, key=lambda p: p["ms"]):
        if not front or p["own"] < front[-1]["own"]:
            front.append(p)
    for a, b in zip(front, front[1:]):
        if b["own"] <= error <= a["own"]:
            share = math.log(error / a["own"]) / math.log(b["own"] / a["own"])
            return math.exp(math.log(a["ms"]) + share * math.log(b["ms"] / a["ms"]))
    return None


def rival_lines(data, found):
    rivals = data.raw["rival"]
    if not rivals:
        return []
    names, reached = data.names(), []
    lines = ["**Against path tracing.** The [rival](techniques/rival.md) with two bounces, filtered, 1 to 8 paths a pixel, traced at full and at half resolution, "
             "judged against two bounces (its best case); the planner's choices against all. How many times longer the rival takes for the same error, at "
             "the budget where that is most; `full`: its line without coarse resolution.", "",
             "| scene | rival: errors of its line | chosen | ms | relMSE | rival's ms (full) | times (full) |", "| --- | --- | --- | ---: | ---: | ---: | ---: |"]
    for view in dict.fromkeys((r["scene"], r["camera"]) for r in rivals):
        v = next(i for i, w in enumerate(data.views) if (w["scene"], w["camera"]) == view)
        points = [r for r in rivals if (r["scene"], r["camera"]) == view]
        full = [p for p in points if p["resolution"] == "full"]
        rows = []
        for f in found:
            if f[0] == v and f[5]:
                error, ms = data.error[v, f[2]], data.ms[v, f[2]]
                both, alone = rival_time(points, error), rival_time(full, error)
                if both or alone:
                    rows.append(((both or 0) / ms, (alone or 0) / ms, f[2], ms, error, both, alone))
        span = f"{max(p['own'] for p in points):.2g} to {min(p['own'] for p in points):.2g}"
        if not rows:
            errors = [data.error[v, f[2]] for f in found if f[0] == v and f[5]]
            lines.append(f"| {view_name(data.views[v])} | {span} | none within that range: {max(errors):.2g} to {min(errors):.2g} | | | | |")
            continue
        _, _, c, ms, error, both, alone = max(rows)
        if both and both >= WANTED_TIMES * ms:
            reached.append(view_name(data.views[v]))
        dash = lambda x, d=0: f"{x:.{d}f}" if x else "none"  # noqa: E731
        lines.append(f"| {view_name(data.views[v])} | {span} | `{short(names[c])}` | {ms:.1f} | {error:.2g} | {dash(both)} ({dash(alone)}) | "
                     f"{dash(both / ms if both else None, 1)} ({dash(alone / ms if alone else None, 1)}) |")
    count = len({(r["scene"], r["camera"]) for r in rivals})
    return lines + ["", f"At least {WANTED_TIMES} times as quick in {len(reached)} of {count} scenes ({'; '.join(reached)}); wanted: 7."]


# -------------------------------------------------------------------------------- docs/accuracy.md

def accuracy_block(data, kept):
    names = data.names()
    lines = [f"Measured {data.raw['date']} at {data.raw['size'][0]}x{data.raw['size'][1]} on {data.raw['device']} for [the planner](planner.md#how-good-it-is): another machine and day "
             "than the rows above, and other settings. ms: median over the views; relMSE against **all bounces**, the truth's noise taken off. In bold the least of a view.", "",
             "| technique | settings | ms | " + " | ".join(view_name(v) for v in data.views) + " |", "| --- | --- | ---: |" + " ---: |" * len(data.views)]
    least = data.error.argmin(axis=1)
    for c, (technique, settings) in enumerate(data.candidates):
        cells = [("**{}**" if least[v] == c else "{}").format(f"{data.error[v, c]:.2g}") for v in range(len(data.views))]
        lines.append(f"| {technique} | `{short(settings) or 'defaults'}` | {np.median(data.ms[:, c]):.1f} | " + " | ".join(cells) + " |")
    hybrids = [c for c, (t, _) in enumerate(data.candidates) if t == "fallback"]
    near = [names[c] for c in hybrids if c in kept]
    lines += ["", "Hybrids (`fallback`) that are within 5 % of a view's front: " + (", ".join(f"`{short(n)}`" for n in near) if near else
              "none. What `horizon` or `screen_space` knows of near light costs more than as many clusters or bounces more, and darkens what lies "
              "beyond the picture's sides") + "."]
    return lines
