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
from results import Results, counted, errors, front, geometric_mean, is_drawn, means_over_views, value  # noqa: E402

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
    lines += means_text(results) + [""] + rows_table(results) + [""] + rivalry(results) + front_table(results) + [""]
    for technique in results.techniques:
        lines += technique_text(results, technique)
    return lines + not_drawn_text(results)


def conditions(results):
    header = results.header
    low, high = results.loads()
    text = (f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]} on {results.device_text()}, "
            f"{header['versions']['threads']} threads ({header['versions']['cpu']}); build {header['versions']['compiler']}, Embree "
            f"{header['versions']['embree']}; {len(results.points)} points in {counted(len(results.views), 'view')}. Time: host's images to host's "
            f"output. Load average {low:.1f} to {high:.1f}")
    if results.time() == "processor":
        text += (": other work kept the machine busy, so **ms is processor time of all threads divided by their number**, what a frame "
                 "takes at least on this machine at rest; the host's clock, which that work lengthened, stands beside it.")
    elif results.is_busy():
        text += ": the machine was shared, so that times are too long."
    else:
        text += ": the machine was ours alone."
    block = header.get("judged_block", 1)
    if block > 1:
        text += (f" The irradiance is judged at one pixel of each {block} x {block}; score and FLIP stand in brackets where the truth of whole "
                 "pictures is too noisy for them.")
    return [text]


def percent(error):
    return f"{100.0 * error:.0f} %"


def ms(results, point):
    return point["ms"][results.time()]


def settings_text(point):
    return f"`{point['settings']}`" + (f" ({point['label']})" if point["label"] and point["label"] != point["settings"] else "")


def means_text(results):
    means, left = means_over_views(results)
    best = front(means, time=results.time())
    if not best:
        return ["No setting has a trusted error in enough views, so there are no means."]
    quick, accurate = best[0], best[-1]
    text = [f"Over {counted(len(results.shared), 'view')} (geometric means), the quickest point of the front is {quick['technique']} "
            f"{settings_text(quick)}: {ms(results, quick):.1f} ms at a relMSE of {value(quick):.3g}. The most accurate is "
            f"{accurate['technique']} {settings_text(accurate)}: {ms(results, accurate):.1f} ms at {value(accurate):.3g}, "
            f"{ms(results, accurate) / ms(results, quick):.0f} times the time for {value(quick) / value(accurate):.1f} times less error. "
            f"{len(best)} of {len(means)} settings are on the front."]
    some = [m for m in means if is_drawn(m) and m["errors"]["own"]["views"] < len(results.shared)]
    if some:
        text.append(f"{len(some)} settings are too accurate for some views' truths; there they are taken to stand to the defaults as in the "
                    "other views.")
    if left:
        text.append(f"{len(left)} settings are left out of the means: not in every view, or too accurate for the truths of more than half "
                    "of them.")
    return text


MOST_ROWS = 16  # of one technique; of those with more settings the defaults and what MARKED picks
MARKED = "visibility=voxel"


def rows_table(results):
    """Settings beside each other, view by view: what a geometric mean hides. In bold the least of a view among as many bounces."""
    groups = {}
    for point in results.points:
        groups.setdefault((point["technique"], point["settings"]), []).append(point)
    counts = {t: sum(1 for technique, _ in groups if technique == t) for t in results.techniques}
    rows = [(key, group) for key, group in groups.items() if counts[key[0]] <= MOST_ROWS or MARKED in key[1] or
            "default" in group[0]["label"].split(", ")]
    rows.sort(key=lambda row: results.techniques.index(row[0][0]))
    place = lambda p: (p["scene"], p["camera"])  # noqa: E731
    least = {}
    for _, group in rows:
        for p in (p for p in group if is_drawn(p)):
            key = (place(p), p["bounces"])
            least[key] = min(least.get(key, value(p)), value(p))
    lines = ["relMSE of each view against as many bounces as a setting models (\\* two, \\*\\* all), ms the geometric mean; in bold the least of a view "
             "among these of as many bounces, in brackets what the truth's noise may have made:", "",
             "| technique | settings | ms | " + " | ".join(f"{v['scene']}, {v['camera'].replace('suggested_', '')}" for v in results.views) + " |",
             "| --- | --- | ---: | " + " | ".join("---:" for _ in results.views) + " |"]
    for (technique, settings), group in rows:
        known, cells = {place(p): p for p in group}, []
        for view in results.views:
            p = known.get((view["scene"], view["camera"]))
            text = "" if p is None or not errors(p) else f"{errors(p)['relMSE']:.2g}"
            if text and not is_drawn(p):
                text = f"({text})"
            elif text and value(p) == least[place(p), p["bounces"]]:
                text = f"**{text}**"
            cells.append(text)
        bounces = {1: "", 2: " \\*"}.get(group[0]["bounces"], " \\*\\*")
        timed = [ms(results, p) for p in group if p["ms"] is not None]
        mean = f"{geometric_mean(timed):.1f}" if timed else ""
        lines.append(f"| {technique}{bounces} | `{settings}` | {mean} | " + " | ".join(cells) + " |")
    return lines


def default_of(points):
    return next((p for p in points if "default" in p["label"].split(", ") and is_drawn(p)), None)


def rivalry(results):
    """Each library technique's defaults beside what the rival does in the same time, and in what time it does the same."""
    if "rival" not in results.techniques:
        return []
    lines = []
    for technique in [t for t in results.techniques if t != "rival"]:
        rows = [row for row in (rivalry_row(results, view, technique) for view in results.shared) if row]
        if not rows:
            continue
        count = {1: "one bounce", 2: "two bounces"}.get(rows[0][1]["bounces"], "all bounces")
        lines += [f"**{technique} and the rival.** Against the light of {count}, {technique} by its defaults and the rival's sweep of {count}:", "",
                  f"| view | {technique}: ms | relMSE | rival in no more time: ms | relMSE | rival with no more error: ms | relMSE |",
                  "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
        for view, ours, quick, accurate in rows:
            cells = [f"{ms(results, p):.1f} | {value(p):.3g}" if p else "none | " for p in (ours, quick, accurate)]
            lines.append(f"| {view['scene']}, {view['camera']} | " + " | ".join(cells) + " |")
        lines += ["", rivalry_sentence(results, technique, rows), ""]
    return lines


def rivalry_row(results, view, technique):
    points = results.of_view(view)
    ours = default_of([p for p in points if p["technique"] == technique])
    if ours is None:
        return None
    rivals = [p for p in points if p["technique"] == "rival" and p["bounces"] == ours["bounces"] and p["ms"] is not None]
    if not rivals:  # none of as many bounces was measured
        return None
    within = [p for p in rivals if ms(results, p) <= ms(results, ours) and is_drawn(p)]
    # A point too accurate for the truth is no more wrong than ours, though nobody knows by how much.
    as_good = [p for p in rivals if errors(p) and (errors(p)["relMSE"] <= value(ours))]
    return (view, ours, min(within, key=value, default=None), min((p for p in as_good if is_drawn(p)), key=lambda p: ms(results, p), default=None))


OF_VPLS = {"rsm", "ssvp", "static_vpl", "instant_radiosity"}


def rivalry_sentence(results, technique, rows):
    ahead = [view for view, ours, quick, _ in rows if quick is None or value(quick) > value(ours)]
    ratios = [(ms(results, accurate) / ms(results, ours), view["scene"]) for view, ours, _, accurate in rows if accurate]
    text = f"In the time of its defaults {technique} is ahead in {len(ahead)} of {len(rows)} views"
    text += f" ({', '.join(view['scene'] for view in ahead)})." if ahead else "."
    if ratios:
        least, most = min(ratios), max(ratios)
        text += (f" For the same error the rival takes {least[0]:.2g} ({least[1]}) to {most[0]:.2g} times ({most[1]}) its time." if len(ratios) > 1
                 else f" For the same error the rival takes {least[0]:.2g} times its time ({least[1]}).")
    behind = [(view, ours, quick) for view, ours, quick, _ in rows if quick is not None and value(quick) <= value(ours)]
    if behind and technique in OF_VPLS:
        bright = sum(errors(ours)["bias"] > 0.1 for _, ours, _ in behind)
        text += (f" Where it is behind, its mean is more than a tenth too bright in {bright} of {len(behind)} views: light that "
                 "comes through walls, which no number of VPLs mends.")
    return text


def front_table(results):
    clock = results.time() == "processor"
    lines = ["| view | technique | settings on the front | ms | " + ("clock ms | " if clock else "") + "relMSE | nRMSE | bias | score | FLIP |",
             "| --- | --- | --- | ---: | " + ("---: | " if clock else "") + "---: | ---: | ---: | ---: | ---: |"]
    for view in results.views:
        for point in thinned(front(results.of_view(view), time=results.time())):
            own = errors(point)
            lines.append(f"| {view['scene']}, {view['camera']} | {point['technique']} | {settings_text(point)} | "
                         f"{ms(results, point):.1f} | " + (f"{point['ms']['median']:.0f} | " if clock else "") +
                         f"{own['relMSE']:.3g} | {own['nrmse']:.3g} | {100 * own['bias']:+.1f} % | {composite_cells(point)} |")
    return lines


def composite_cells(point):
    """Score and FLIP; in brackets where the truth of whole pictures is too noisy for them."""
    own = errors(point)
    cells = [f"{own['score']:.2f}", f"{own['flip']:.3f}"]
    return " | ".join(cells if is_drawn(point, metric="flip") else [f"({cell})" for cell in cells])


def thinned(points, most=4):
    if len(points) <= most:
        return points
    return [points[round(i * (len(points) - 1) / (most - 1))] for i in range(most)]


def technique_text(results, technique):
    """What the figures say about one technique: where it is worst and best, what parameters buy."""
    defaults = [p for p in results.points if p["technique"] == technique and "default" in p["label"].split(", ") and errors(p)]
    lines = [f"**{technique}**, defaults:", ""]
    lines += ["| view | ms | clock: median | p99 ms | relMSE | nRMSE | bias | score | FLIP | relMSE to all bounces | bias to all bounces | noise |",
              "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for p in defaults:
        own, every = errors(p), errors(p, "all")
        mark = "" if is_drawn(p) else " (not trusted)"
        others = f"{every['relMSE']:.3g} | {100 * every['bias']:+.1f} %" if every and is_drawn(p, "all") else " | "
        lines.append(f"| {p['scene']}, {p['camera']} | {ms(results, p):.1f} | {p['ms']['median']:.1f} | {p['ms']['p99']:.1f} | {own['relMSE']:.3g}{mark} | "
                     f"{own['nrmse']:.3g} | {100 * own['bias']:+.1f} % | {composite_cells(p)} | {others} | "
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
        gains.append((value(default) / value(best), ms(results, best) / ms(results, default), view["scene"], best))
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
