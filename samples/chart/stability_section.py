"""Section of the report for `lightwell stability`: where techniques fail over time."""
import html

from report import HERE, ReportError, Section, data_uri, table
from stability_results import COLUMNS, INDICES, LEVELS, StabilityResults, figure, level, short

FILE, ORDER = "stability.json", 30

BODY = """<p>Each failure is a sequence of frames built to provoke it, with a path-traced truth for each frame. The figures are
relative to the truth's light: 0 is best for all of them. In small grey: the <em>floor</em>, what a second truth reads, by its
noise alone; figures too close to it stand on grey. <code>docs/stability.md</code> states each formula and what it is blind to.</p>
<dl class="stability-words">{words}</dl>
<h2>Techniques and failures</h2>
<form class="stability-choice"><label>figure <select id="stability-figure">{options}</select></label>{legend}</form>
<div class="wide" id="stability-matrix"></div>
<h2>All figures</h2>
<p>A click on a head sorts.</p>
<div class="wide">{figures}</div>
{failed}
<h2>Over time</h2>
<p>Solid: techniques; dotted: the floor. Grey lines: cuts and changes of size. Where a figure has nothing to be judged by
there is no line.</p>
{sequences}
<h2>Measured on</h2>
<div class="wide">{head}</div>
"""


def make(folder):
    results = StabilityResults(folder / FILE)
    if not results.results:
        raise ReportError(f"{folder / FILE}: expected results of at least one technique, got none")
    from stability_plots import write_plots  # matplotlib takes a second
    plots = write_plots(results)
    words = "".join(f"<dt>{html.escape(title)}</dt><dd>{html.escape(text)}; noticed from about {noticed:g} on</dd>"
                    for title, noticed, text in COLUMNS.values())
    options = "".join(f'<option value="{key}">{html.escape(title)}</option>' for key, (title, _, _) in COLUMNS.items())
    legend = "".join(f'<span class="stability-{key}">{html.escape(text)}</span>' for key, text in LEVELS.items() if key != "exact")
    body = BODY.format(words=words, options=options, legend=f'<span class="stability-legend">{legend}</span>',
                       figures=all_figures(results), failed=failed(results),
                       sequences="".join(sequence_part(results, s, plots) for s in results.sequences), head=head(results))
    return Section("Stability", body, matrix(results), (HERE / "stability_section.js").read_text(encoding="utf-8"),
                   (HERE / "stability_section.css").read_text(encoding="utf-8"),
                   list(plots.values()))


def cell(result, key):
    """What one figure is on the page: text, floor, level, value to sort by."""
    value, floor = figure(result, key) if result else (None, None)
    return {"text": short(value), "floor": short(floor), "level": level(key, value, floor), "value": value}


def matrix(results):
    """For the script: every figure as technique x failure."""
    return {"techniques": results.techniques,
            "sequences": [{"id": s["id"], "failure": s["failure"],
                           "cells": {key: [cell(results.of(t, s), key) for t in results.techniques] for key in COLUMNS}}
                          for s in results.sequences]}


def figure_cell(result, key):
    content = cell(result, key)
    sort = "" if content["value"] is None else f' data-value="{content["value"]!r}"'
    floor = f"<small>{content['floor']}</small>" if content["floor"] else ""
    return f'<td class="number stability-{content["level"]}"{sort}>{content["text"]}{floor}</td>'


def all_figures(results):
    heads = ["failure", "technique"] + [title for title, _, _ in COLUMNS.values()] + ["worst frame", "by"]
    rows = []
    for sequence in results.sequences:
        for technique in results.techniques:
            result = results.of(technique, sequence)
            if result is None:
                continue
            cells = f'<td><a href="#stability-{html.escape(sequence["id"])}">{html.escape(sequence["id"])}</a></td>'
            cells += f"<td>{html.escape(technique)}</td>" + "".join(figure_cell(result, key) for key in COLUMNS)
            cells += f'<td class="number" data-value="{result["worst_frame"]}">{result["worst_frame"]}</td>'
            rows.append(f"<tr>{cells}<td>{html.escape(result['worst_reason'])}</td></tr>")
    head_row = "".join(f"<th>{html.escape(title)}</th>" for title in heads)
    return f'<table id="stability-figures"><thead><tr>{head_row}</tr></thead><tbody>{"".join(rows)}</tbody></table>'


def failed(results):
    """Sequences that must be exactly dark and finite, and are not."""
    bad = [r for r in results.results if not r.get("passes", True)]
    if not bad:
        return ""
    rows = [(r["technique"], r["sequence"], r["not_finite"], short(r["largest"]), "yes" if r["is_dark_truth"] else "no") for r in bad]
    return ("<h3>Light that must not be</h3>" +
            table(["technique", "failure", "values not finite", "largest, W/m²", "should be 0"], rows, numbers_from=2))


def sequence_part(results, sequence, plots):
    width, height = sequence["size"]
    facts = [f"{sequence['frames']} frames of {width} x {height}"]
    facts.append("truth: dark" if sequence["truth"] == "dark" else f"truth: {sequence['samples']} paths per pixel")
    if sequence.get("sweeps"):
        facts.append(f"sweeps {sequence['sweeps']}: {sequence['values'][0]:g} to {sequence['values'][-1]:g}")
    if sequence.get("scale", 1.0) != 1.0:
        facts.append(f"lengths times {sequence['scale']:g}")
    pictures = "".join(worst_picture(results, results.of(t, sequence)) for t in results.techniques if results.of(t, sequence))
    name, plot = html.escape(sequence["id"]), results.folder / plots[sequence["id"]]
    return (f'<section id="stability-{name}"><h3>{name}: {html.escape(sequence["failure"])}</h3>'
            f'<p class="note">{html.escape("; ".join(facts))}</p>'
            f'<img class="stability-plot" alt="figures over time, {name}" src="{data_uri(plot)}">{pictures}</section>')


def worst_picture(results, result):
    """The worst frame: ours, truth, error map."""
    images = result.get("images") or {}
    shown = [(kind, images[kind]) for kind in ("picture", "truth", "error") if images.get(kind)]
    if not shown:
        return ""
    for kind, name in shown:
        if not (results.folder / name).is_file():
            raise ReportError(f"{results.folder / FILE}: {result['id']}: {kind}: expected the picture {name}, found none")
    title = html.escape(f"{result['technique']}, frame {result['worst_frame']}, the worst by {result['worst_reason']}")
    pictures = "".join(f'<figure><img loading="lazy" alt="{kind}" src="{data_uri(results.folder / name)}">'
                       f"<figcaption>{kind}</figcaption></figure>" for kind, name in shown)
    return f'<div class="stability-worst"><p>{title}</p>{pictures}</div>'


def head(results):
    header = results.header
    rows = [("size", "{} x {} pixels".format(*header["size"]) + f", {header['frames']} frames" +
             (", quick form" if header["quick"] else "")), ("written", header["written"])]
    if header.get("device"):
        rows.append(("device", "{name}, {platform} {driver}, {opencl}, {compute_units} compute units, width {width}"
                     .format(**header["device"])))
    rows += list(header["versions"].items())
    for technique in results.techniques:
        settings = list(dict.fromkeys(r["settings"] for r in results.results if r["technique"] == technique))
        rows.append((technique, "; ".join(settings)))
    others = len(results.others_build())
    if others:
        rows.append(("builds", f"{others} of {len(results.results)} results are of another build than the last run"))
    return table(["", ""], rows)
