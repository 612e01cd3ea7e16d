#!/usr/bin/env python3
"""Writes the measured part of docs/accuracy.md, and docs/images/chart_summary.svg, from what `lightwell chart` measured.

    docs/figures/accuracy.py [--results build/chart] [--lightwell build/release/bin/lightwell] [chart options ...]

Charts first where --results holds no results.json, with the options that follow (such as --size 640x360); hours where
truths are not cached yet.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "samples" / "chart"))
from results import Results, errors, front, is_drawn, means_over_views, value  # noqa: E402

BEGIN, END = "<!-- begin: written by docs/figures/accuracy.py -->", "<!-- end -->"
SCENES = ["cornell", "basic", "rooms", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "wooden_staircase"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--results", default=str(ROOT / "build/chart"))
    options, chart_options = parser.parse_known_args()
    folder = pathlib.Path(options.results)
    if not (folder / "results.json").exists():
        command = [options.lightwell, "chart", "--out", str(folder), "--scenes", *SCENES, *chart_options]
        if subprocess.run(command, check=False).returncode != 0:
            sys.exit("lightwell chart failed")
    results = Results(folder)
    text = "\n".join(measured(results))
    page = ROOT / "docs/accuracy.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1], encoding="utf-8")
    shutil.copy(folder / "summary.svg", ROOT / "docs/images/chart_summary.svg")
    print(page)


def measured(results):
    lines = conditions(results)
    lines += ["", "![Error against time, geometric means over the views](images/chart_summary.svg)", ""]
    lines += means_text(results) + [""] + front_table(results) + [""]
    for technique in results.techniques:
        lines += technique_text(results, technique)
    return lines + not_drawn_text(results)


def conditions(results):
    header = results.header
    loads = [p["load_average"] for p in results.points]
    return [f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]} on {results.device_text()}, "
            f"{header['versions']['threads']} threads; load average {min(loads):.1f} to {max(loads):.1f} (the machine was "
            f"{'shared, so that times are too long' if max(loads) > 2.5 else 'ours alone'}). {len(results.points)} points in "
            f"{len(results.views)} view{'s' * (len(results.views) > 1)}. Time: host's images to host's output. Truth: as many bounces as the technique models."]


def percent(error):
    return f"{100.0 * error:.0f} %"


def settings_text(point):
    return f"`{point['settings']}`" + (f" ({point['label']})" if point["label"] and point["label"] != point["settings"] else "")


def means_text(results):
    means, left = means_over_views(results)
    best = front(means)
    if not best:
        return ["No setting has a trusted error in every view, so there are no means."]
    quick, accurate = best[0], best[-1]
    text = [f"Over all views (geometric means), the quickest point of the front is {quick['technique']} {settings_text(quick)}: "
            f"{quick['ms']['median']:.1f} ms at a relMSE of {value(quick):.3g}. The most accurate is {accurate['technique']} "
            f"{settings_text(accurate)}: {accurate['ms']['median']:.1f} ms at {value(accurate):.3g}, "
            f"{accurate['ms']['median'] / quick['ms']['median']:.0f} times the time for {value(quick) / value(accurate):.1f} times less error. "
            f"{len(best)} of {len(means)} settings are on the front."]
    if left:
        text.append(f"{len(left)} settings are left out of the means: not in every view, or too accurate for a truth's noise.")
    return text


def front_table(results):
    lines = ["| view | technique | settings on the front | ms | relMSE | nRMSE | bias | score | FLIP |",
             "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for view in results.views:
        for point in thinned(front(results.of_view(view))):
            own = errors(point)
            lines.append(f"| {view['scene']}, {view['camera']} | {point['technique']} | {settings_text(point)} | "
                         f"{point['ms']['median']:.1f} | {own['relMSE']:.3g} | {own['nrmse']:.3g} | {100 * own['bias']:+.1f} % | "
                         f"{own['score']:.2f} | {own['flip']:.3f} |")
    return lines


def thinned(points, most=4):
    if len(points) <= most:
        return points
    return [points[round(i * (len(points) - 1) / (most - 1))] for i in range(most)]


def technique_text(results, technique):
    """What the figures say about one technique: where it is worst and best, what parameters buy."""
    defaults = [p for p in results.points if p["technique"] == technique and "default" in p["label"].split(", ")]
    lines = [f"**{technique}**, defaults:", ""]
    lines += ["| view | ms | p99 ms | relMSE | nRMSE | bias | score | FLIP | relMSE to all bounces | bias to all bounces | noise |",
              "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for p in defaults:
        own, every = errors(p), errors(p, "all")
        mark = "" if is_drawn(p) else " (not trusted)"
        others = f"{every['relMSE']:.3g} | {100 * every['bias']:+.1f} %" if every and is_drawn(p, "all") else " | "
        lines.append(f"| {p['scene']}, {p['camera']} | {p['ms']['median']:.1f} | {p['ms']['p99']:.1f} | {own['relMSE']:.3g}{mark} | "
                     f"{own['nrmse']:.3g} | {100 * own['bias']:+.1f} % | {own['score']:.2f} | {own['flip']:.3f} | {others} | "
                     f"{own['noise']:.1e} |")
    trusted = [p for p in defaults if is_drawn(p)]
    if trusted:
        worst, best = max(trusted, key=value), min(trusted, key=value)
        span = f"{percent(value(best) ** 0.5)} in {best['scene']}"
        if worst is not best:
            span = f"from {span} to {percent(value(worst) ** 0.5)} in {worst['scene']}"
        lines += ["", f"Typical relative error (the root of relMSE) of the defaults: {span}. " + bias_sentence(trusted) +
                  more_sentence(results, technique)]
    return lines + [""]


def bias_sentence(points):
    bright = [p for p in points if errors(p)["bias"] > 0.02]
    dark = [p for p in points if errors(p)["bias"] < -0.02]
    parts = []
    for some, word in ((bright, "bright"), (dark, "dark")):
        if some:
            extreme = max(some, key=lambda p: abs(errors(p)["bias"]))
            parts.append(f"too {word} in {len(some)} of {len(points)} views (most in {extreme['scene']}: {100 * errors(extreme)['bias']:+.0f} %)")
    return ("On the whole it is " + " and ".join(parts) + ". ") if parts else "Its mean is right to 2 % everywhere. "


def more_sentence(results, technique):
    """What the dearest setting buys over the defaults, view by view."""
    gains = []
    for view in results.views:
        points = [p for p in results.of_view(view) if p["technique"] == technique and is_drawn(p)]
        default = next((p for p in points if "default" in p["label"].split(", ")), None)
        if default is None:
            continue
        best = min(points, key=value)
        gains.append((value(default) / value(best), best["ms"]["median"] / default["ms"]["median"], view["scene"], best))
    if not gains:
        return ""
    least, most = min(gains, key=lambda g: g[0]), max(gains, key=lambda g: g[0])
    text = f"The best trusted setting of its sweep lowers relMSE by a factor of {least[0]:.1f} ({least[2]}"
    if most is not least:
        text += f") to {most[0]:.1f} ({most[2]}"
    text += f", `{most[3]['settings']}`, {most[1]:.1f} times the time)."
    if most[0] < 2.0:
        text += " So little do its parameters buy: most of its error is not theirs to remove."
    return text


def not_drawn_text(results):
    hidden = [p for p in results.points if not is_drawn(p)]
    if not hidden:
        return ["Every point's error is at least ten times its truth's noise."]
    per_view = {}
    for p in hidden:
        per_view[p["scene"]] = per_view.get(p["scene"], 0) + 1
    return [f"{len(hidden)} of {len(results.points)} points are not drawn, for the truth's noise exceeds a tenth of their error: " +
            ", ".join(f"{n} in {scene}" for scene, n in per_view.items()) + "."]


if __name__ == "__main__":
    main()
