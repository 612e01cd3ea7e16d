"""The part of docs/figures/planner_page.py that docs/choosing.md has: which technique for which inputs and budget. Against the rival: planner_rival.py."""
import math

import matplotlib.pyplot as plt
import numpy as np

import planner_rival
from planner_model import BUDGETS
from planner_page import COLOURS, save, short, view_name

# What a host may have, and which bits of PlanNeeds that is.
INPUTS = [("RSMs, triangles, G-buffer with direct light, source views", 64 + 15), ("RSMs, triangles, G-buffer with direct light", 15), ("RSMs and G-buffer, no triangles", 7), ("G-buffer with direct light alone", 6),
          ("G-buffer without light", 4)]
DRAWN_BUDGETS = np.geomspace(4, 100, 200)


def best_by_budget(data, able, budget, rows=None):
    """Of candidates that at the median keep the budget: the least geometric mean of errors."""
    rows = np.arange(len(data.views)) if rows is None else rows
    affordable = [c for c in able if np.median(data.ms[rows, c]) <= budget]
    return min(affordable, key=lambda c: data.log[rows, c].mean()) if affordable else None


def draw(data, needs, kept):
    figure, every = plt.subplots(len(INPUTS), 1, figsize=(9.2, 1.5 * len(INPUTS) + 0.8), dpi=100, sharex=True)
    names = data.names()
    for axes, (title, have) in zip(every, INPUTS):
        able = [c for c in kept if needs[c] & ~have == 0]
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
                axes.text(math.sqrt(low * high), 0.5, text, ha="center", va="center", fontsize=6.2 if wide > 0.5 else 5.2, rotation=0 if wide > 0.5 else 90)
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


def block(data, needs, kept, heldOut, found):
    names = data.names()
    lines = [f"Measured {data.raw['date']} at {data.raw['size'][0]}x{data.raw['size'][1]} on {data.raw['device']}, {data.raw['threads']} threads; see "
             "[the planner](planner.md#how-good-it-is) for how. Of the planner's rows; relMSE against all bounces, geometric mean over the views; in brackets the least and the "
             "largest of them.", "", "![What to take for which inputs and budget](images/choosing.png)", "",
             "| what the host has | " + " | ".join(f"{b} ms" for b in BUDGETS) + " |", "| --- |" + " --- |" * len(BUDGETS)]
    for title, have in INPUTS:
        able = [c for c in kept if needs[c] & ~have == 0]
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
    return lines + [""] + planner_rival.block(data, kept, heldOut, found)


STEPS = [("bounces 2 to 4", "ssvp clusters=16 resolution=half", "ssvp clusters=16 bounces=4 resolution=half"),
         ("clusters 8 to 16", "ssvp bounces=4 resolution=half", "ssvp clusters=16 bounces=4 resolution=half"),
         ("clusters 16 to 32", "ssvp clusters=16 bounces=4 resolution=half", "ssvp clusters=32 bounces=4 resolution=half"),
         ("VPLs 256 to 512", "ssvp clusters=16 bounces=4 resolution=half", "ssvp vpls=512 clusters=16 bounces=4 resolution=half"),
         ("VPLs 256 to 1,024", "ssvp clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half"),
         ("clusters 32 to 64", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"),
         ("VPLs of later bounces 8 to 16 a cluster", "ssvp vpls=1024 clusters=32 second_vpls=8 visibility=careful bounces=4 resolution=quarter",
          "ssvp vpls=1024 clusters=32 second_vpls=16 visibility=careful bounces=4 resolution=quarter"),
         ("the same, 16 to 32", "ssvp vpls=1024 clusters=32 second_vpls=16 visibility=careful bounces=4 resolution=quarter",
          "ssvp vpls=1024 clusters=32 visibility=careful bounces=4 resolution=quarter"),
         ("interleave 4 to 8", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 interleave=8 resolution=half"),
         ("only the first bounce shadowed", "ssvp clusters=16 bounces=4 resolution=quarter", "ssvp clusters=16 bounces=4 shadowed_bounces=1 resolution=quarter"),
         ("third bounce shadowed too", "ssvp vpls=1024 clusters=64 bounces=4 resolution=quarter",
          "ssvp vpls=1024 clusters=64 bounces=4 shadowed_bounces=3 resolution=quarter"),
         ("maps of 128 to 256", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 map_size=256 bounces=4 resolution=half"),
         ("quarter to half resolution", "ssvp vpls=512 clusters=16 bounces=4 resolution=quarter", "ssvp vpls=512 clusters=16 bounces=4 resolution=half"),
         ("the same, more of all", "ssvp vpls=1024 clusters=64 bounces=4 resolution=quarter", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"),
         ("visibility hard to strict", "ssvp vpls=512 clusters=16 bounces=4 resolution=quarter",
          "ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=quarter"),
         ("the same, more of all", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half",
          "ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=half"),
         ("strict to careful", "ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=quarter", "ssvp vpls=512 clusters=16 visibility=careful bounces=4 resolution=quarter"),
         ("the same, more of all", "ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=quarter",
          "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 resolution=quarter"),
         ("VPLs by flux to by view", "ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=quarter",
          "ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 resolution=quarter"),
         ("the same, third bounce shadowed", "ssvp vpls=1024 clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter",
          "ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter"),
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


STRICT = ["ssvp vpls=512 clusters=16{} bounces=4 resolution=quarter", "ssvp vpls=1024 clusters=64{} bounces=4 resolution=quarter",
          "ssvp vpls=1024 clusters=64{} bounces=4 resolution=half"]


def strict_block(data):
    """What docs/techniques/ssvp_visibility.md says of strict look-ups: both errors of every view, and what they cost."""
    names = data.names()
    pairs = [(names.index(name.format("")), names.index(name.format(" visibility=strict"))) for name in STRICT]
    both = lambda a, b: f"{a:.2g} → {b:.2g}"  # noqa: E731
    lines = [f"{data.raw['size'][0]}x{data.raw['size'][1]}, relMSE against all bounces, `hard` → `strict`, geometric mean of {data.raw['seeds']} sample sets ({max(data.raw['more_seeds'].values())} in {', '.join(data.raw['more_seeds'])}); at the end geometric "
             "means over the views, and medians of the time's ratio in frames at rest.", "",
             "| view | " + " | ".join(f"`{short(name.format(''))}`" for name in STRICT) + " |", "| --- |" + " --- |" * len(STRICT)]
    for v, view in enumerate(data.views):
        lines.append(f"| {view_name(view)} | " + " | ".join(both(data.error[v, a], data.error[v, b]) for a, b in pairs) + " |")
    lines.append("| all | " + " | ".join(both(10 ** data.log[:, a].mean(), 10 ** data.log[:, b].mean()) for a, b in pairs) + " |")
    return lines + ["| time | " + " | ".join(f"x {np.median(data.ms[:, b] / data.ms[:, a]):.2f}" for a, b in pairs) + " |"]
