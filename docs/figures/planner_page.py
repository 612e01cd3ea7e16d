"""What docs/figures/planner.py writes into pages: tables and pictures of the planner's fit, of choosing, and of errors."""
import math
import pathlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from planner_model import BUDGETS, outcomes  # noqa: E402
from program import write_between  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- begin: written by docs/figures/planner.py -->", "<!-- end: planner -->"
COLOURS = {"rsm": "#d98b2b", "ssvp": "#1f6fb4", "lpv": "#3f9b57", "cone_tracing": "#8a5bb0", "screen_space": "#c2464a", "horizon": "#7d6a55",
           "ao": "#999999", "fallback": "#3bb0b8"}


def short(name):
    return name.replace("resolution=half", "half").replace("resolution=quarter", "quarter").replace("shadowed_bounces", "shadowed").replace("visibility=strict", "strict").replace("visibility=careful", "careful").replace("sampling=view", "view")


def view_name(view):
    camera = view["camera"].replace("suggested_", "")
    return f"{view['scene']}, {camera}"


def write(data, kept, heldOut, ridges, sigma, model, costs):
    from planner import needs_of
    import planner_choosing
    needs = np.array([needs_of(*c) for c in data.candidates])
    ms, log = heldOut
    everything = np.arange(len(data.views))
    found = outcomes(data, ms, log, everything, kept)
    draw_predicted(data, kept, ms, log)
    planner_choosing.draw(data, needs, kept)
    write_between(ROOT / "docs/planner.md", BEGIN, END, fit_block(data, kept, ms, log, found, ridges, sigma, costs))
    write_between(ROOT / "docs/choosing.md", BEGIN, END, planner_choosing.block(data, needs, kept, heldOut, found))
    write_between(ROOT / "docs/choosing.md", "<!-- begin: thrift, written by docs/figures/planner.py -->", "<!-- end: thrift -->", planner_choosing.thrift_block(data))
    write_between(ROOT / "docs/techniques/ssvp_visibility.md", "<!-- begin: strict, written by docs/figures/planner.py -->", "<!-- end: strict -->",
                  planner_choosing.strict_block(data))
    write_between(ROOT / "docs/accuracy.md", BEGIN, END, accuracy_block(data))


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


def again(raw):
    """What planner_again.py measured once more."""
    def told(run):
        more = "".join(f", {n} in {scene}" for scene, n in run["more_sets"].items())
        what = "of all rows and of path tracing" if not run["rows"] else f"{'of the table, where VPLs are drawn,' if run['rows'] == 'table' else 'with `' + run['rows'] + '`'} ({run['sets']} sets{more})"
        made = f", of {run['made_rows']} rows also in made-up scenes ({' or '.join(map(str, run['made_sets']))} sets; others 3)" if run["made_rows"] else ""
        return f" Errors {what} were measured again on {run['date']}{made}."
    return "".join(map(told, raw.get("errors_again", [])))


def fit_block(data, kept, ms, log, found, ridges, sigma, costs):
    raw = data.raw
    off = np.abs(ms[:, kept] / data.ms[:, kept] - 1.0)
    byScene = log[:, kept] - data.log[:, kept]
    twice = np.mean(np.abs(byScene) <= math.log10(2))
    said = np.mean([math.erf(math.log10(2) / (s * math.sqrt(2))) for s in sigma[kept]])
    ridge, ofView = ridges
    lines = [f"Measured {raw['date']} at {raw['size'][0]}x{raw['size'][1]} on {raw['device']}, {raw['threads']} threads of one shared machine: time is processor time of "
             f"all threads over their number, times {raw['clock_over_processor']:.3f}, what the clock showed beyond it where nothing else ran. "
             f"{len(data.candidates)} configurations in {len(data.views)} views of {len(set(v['scene'] for v in data.views))} scenes; {len(kept)} of them, within 5 % of a front "
             "in two scenes or more, are the table, which holds no hard maps where strict ones are measured, no maps of 256 x 256, and none of `lpv`, `cone_tracing`, `ao`, `fallback` and `visibility=voxel`, which made-up scenes lack. Errors are against all bounces, at one pixel of each "
             f"{raw['judged_block']} x {raw['judged_block']}, the geometric mean over {raw['seeds']} sample sets where VPLs are drawn ({max(raw['more_seeds'].values())} in {', '.join(raw['more_seeds'])}, where they lie farthest apart); the truth's own noise ({min(v['noise'] for v in data.views):.1g} to {max(v['noise'] for v in data.views):.1g}) is taken off." + again(raw), "",
             "Everything below is *leave one scene out*: each view is predicted by models that were fitted without its scene (the two Cornell "
             f"boxes count as one), with the ridges chosen within the scenes that are left. {len(data.madeLog)} made-up scenes teach errors to all of them and are not judged. The fit to all: "
             f"ridge {ridge:g} of what tells candidates apart, " + (f"{ofView:g} of what is alike for all." if math.isfinite(ofView) else "nothing that is alike for all."), "",
             "![Predicted against measured, scenes left out](images/planner_predicted.png)", "",
             f"**Time**: off by {100 * np.median(off):.1f} % at the median, {100 * np.quantile(off, 0.9):.0f} % at the ninth decile (wanted: 15 % at the median). "
             f"**Error**: within a factor of two in {100 * twice:.0f} % of all predictions (the confidences say {100 * said:.0f} %). Most of what is off is alike for all "
             f"candidates of a view, and does not change what is chosen. {sky_text(data, kept, costs)}", "",
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


def sky_text(data, kept, costs):
    shares = {data.candidates[c][0]: costs[c, 5] for c in kept}
    return f"In the fit to all, a pixel of sky takes of what one with a surface takes: {', '.join(f'{share:g} of `{t}`' for t, share in sorted(shares.items()))}."


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


# -------------------------------------------------------------------------------- docs/accuracy.md

def accuracy_block(data):
    from planner import near_front
    names = data.names()
    lines = [f"Measured {data.raw['date']} at {data.raw['size'][0]}x{data.raw['size'][1]} on {data.raw['device']} for [the planner](planner.md#how-good-it-is): another machine and day "
             "than the rows above, and other settings. ms: median over the views; relMSE against **all bounces**, the truth's noise taken off. In bold the least of a view.", "",
             "| technique | settings | ms | " + " | ".join(view_name(v) for v in data.views) + " |", "| --- | --- | ---: |" + " ---: |" * len(data.views)]
    least = data.error.argmin(axis=1)
    for c, (technique, settings) in enumerate(data.candidates):
        cells = [("**{}**" if least[v] == c else "{}").format(f"{data.error[v, c]:.2g}") for v in range(len(data.views))]
        lines.append(f"| {technique} | `{short(settings) or 'defaults'}` | {np.median(data.ms[:, c]):.1f} | " + " | ".join(cells) + " |")
    fronts = near_front(data, range(len(names)), 1)
    near = [names[c] for c, (t, _) in enumerate(data.candidates) if t == "fallback" and c in fronts]
    lines += ["", "Hybrids (`fallback`) that are within 5 % of a view's front: " + (", ".join(f"`{short(n)}`" for n in near) if near else
              "none. What `horizon` or `screen_space` knows of near light costs more than as many clusters or bounces more, and darkens what lies "
              "beyond the picture's sides") + "."]
    return lines
