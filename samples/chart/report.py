#!/usr/bin/env python3
"""Plots and the report of what Lightwell's instruments measured.

    report.py DIR

DIR holds results.json of `lightwell chart`, or what other instruments wrote there, or several of them. Writes
each instrument's plots into DIR, and DIR/report.html, one file that opens offline, with a section for each. Needs
matplotlib and D3 5 (Debian: python3-matplotlib node-d3; LIGHTWELL_D3 names another d3.min.js).

The seam: an instrument joins by a file NAME_section.py in this folder (chart_section.py is one), with

    FILE    name of the JSON in DIR that it reads; where DIR has no such file, the report has no such section
    ORDER   whole number: sections stand in this order (chart 10, the error split 20, stability 30)
    make(folder) -> Section
            reads folder / FILE, writes plots into folder, and returns what it adds to the page. Raise
            ReportError(message) for a file that cannot be read as what it should be; its text reaches the user.

and with NAME_*.py, .js, .css beside it as it needs. What a section gives:

    title   heading and entry of the page's contents
    body    HTML below the heading. Escape what comes from the file; pictures as data_uri(path), so that the
            page stays one file; ids and classes begin with NAME- unless they are those of report.css
    data    what the script gets as its `data` (JSON); None: nothing
    script  JavaScript or "": run in a function of its own, function(root, data, d3), `root` being the <section>
    style   CSS or ""
    written names of the files that make() wrote, told to the user
"""
import base64
import html
import importlib
import importlib.util
import json
import os
import pathlib
import sys
from dataclasses import dataclass, field

HERE = pathlib.Path(__file__).resolve().parent
D3_PLACES = ["/usr/share/nodejs/d3/dist/d3.min.js", "/usr/share/javascript/d3/d3.min.js"]
MIME = {".jpg": "image/jpeg", ".png": "image/png", ".svg": "image/svg+xml"}


class ReportError(Exception):
    """What the user must be told; no traceback."""


@dataclass
class Section:
    title: str
    body: str
    data: object = None
    script: str = ""
    style: str = ""
    written: list = field(default_factory=list)


def data_uri(path):
    path = pathlib.Path(path)
    return f"data:{MIME[path.suffix]};base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def table(titles, rows, numbers_from=None):
    """An HTML table of texts, escaped here; columns from `numbers_from` on are aligned to the right."""
    def row(kind, cells):
        return "<tr>" + "".join(f"<{kind}{' class=number' if numbers_from is not None and i >= numbers_from else ''}>"
                                f"{html.escape(str(c))}</{kind}>" for i, c in enumerate(cells)) + "</tr>"
    head = row("th", titles) if any(titles) else ""
    return f"<table><thead>{head}</thead><tbody>{''.join(row('td', cells) for cells in rows)}</tbody></table>"


def read_json(path, form):
    """The JSON of an instrument, whose "format" must be `form`."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except (OSError, ValueError) as error:
        raise ReportError(f"{path}: {error}") from error
    came = data.get("format") if isinstance(data, dict) else type(data).__name__
    if came != form:
        raise ReportError(f"{path}: expected format {form}, got {came}")
    return data


def find_d3():
    chosen = os.environ.get("LIGHTWELL_D3")
    for place in [chosen] if chosen else D3_PLACES:
        if os.path.exists(place):
            return pathlib.Path(place).read_text(encoding="utf-8")
    raise ReportError("the report needs D3, version 5 or later; on Debian: apt-get install node-d3 (LIGHTWELL_D3 names another "
                      "d3.min.js); looked for " + ", ".join([chosen] if chosen else D3_PLACES))


def instruments(here=HERE):
    """(name, module) of every *_section.py, in the order of their sections."""
    names = [path.stem[:-len("_section")] for path in here.glob("*_section.py")]
    found = [(name, importlib.import_module(name + "_section")) for name in names]
    return sorted(found, key=lambda each: (each[1].ORDER, each[0]))


def json_for_page(value):
    """JSON that may stand in a <script>; refuses NaN, which JSON has not."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def page(sections, d3):
    """The page of (name, Section) pairs."""
    contents = "".join(f'<a href="#{name}">{html.escape(section.title)}</a> ' for name, section in sections)
    bodies, scripts = [], []
    for name, section in sections:
        bodies.append(f'<section id="{name}"><h1>{html.escape(section.title)}</h1>\n{section.body}</section>')
        if section.data is not None:
            scripts.append(f'<script id="{name}-data" type="application/json">{json_for_page(section.data)}</script>')
        if section.script:
            data = f'JSON.parse(document.getElementById("{name}-data").textContent)' if section.data is not None else "null"
            scripts.append(f'<script>(function (root, data, d3) {{\n{section.script}\n}})(document.getElementById("{name}"), {data}, d3);'
                           "</script>")
    parts = {"TITLE": html.escape("; ".join(section.title for _, section in sections)),
             "STYLE": (HERE / "report.css").read_text(encoding="utf-8") + "".join(section.style for _, section in sections),
             "CONTENTS": f"<nav>{contents}</nav>" if len(sections) > 1 else "", "SECTIONS": "\n".join(bodies),
             "D3": d3, "SCRIPTS": "\n".join(scripts)}
    text = (HERE / "report.html").read_text(encoding="utf-8")
    for piece in text.split("<!--")[1:]:
        assert piece.split("-->")[0] in parts, piece
    # One pass: what a part holds is no place for another.
    first, *rest = text.split("<!--")
    return first + "".join(parts[piece.split("-->", 1)[0]] + piece.split("-->", 1)[1] for piece in rest)


def make_report(folder):
    """Names of the files written."""
    if not folder.is_dir():
        raise ReportError(f"{folder}: expected a folder of results, found none")
    d3 = find_d3()
    if importlib.util.find_spec("matplotlib") is None:
        raise ReportError(f"the report needs matplotlib, which {sys.executable} has not; on Debian: apt-get install python3-matplotlib, "
                          "and /usr/bin/python3")
    known = instruments()
    present = [(name, module) for name, module in known if (folder / module.FILE).exists()]
    if not present:
        raise ReportError(f"{folder}: expected results, one of {', '.join(module.FILE for _, module in known)}; found none")
    sections = [(name, module.make(folder)) for name, module in present]
    (folder / "report.html").write_text(page(sections, d3), encoding="utf-8")
    return [written for _, section in sections for written in section.written] + ["report.html"]


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    try:
        for name in make_report(folder):
            print(folder / name)
    except (ReportError, OSError) as error:
        sys.exit(f"report: {error}")


if __name__ == "__main__":
    # Sections import what they need from here under this name.
    sys.modules["report"] = sys.modules["__main__"]
    main()
