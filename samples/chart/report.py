#!/usr/bin/env python3
"""Plots and the report of what `lightwell chart` measured.

    report.py DIR

Reads DIR/results.json and DIR/images; writes DIR/SCENE.svg and .png, DIR/summary.svg and .png, and
DIR/report.html, one file that opens offline. Needs matplotlib and D3 5 (Debian: python3-matplotlib node-d3;
LIGHTWELL_D3 names another d3.min.js).
"""
import os
import pathlib
import sys

from results import Results

D3_PLACES = ["/usr/share/nodejs/d3/dist/d3.min.js", "/usr/share/javascript/d3/d3.min.js"]


def find_d3():
    chosen = os.environ.get("LIGHTWELL_D3")
    for place in [chosen] if chosen else D3_PLACES:
        if os.path.exists(place):
            return pathlib.Path(place).read_text(encoding="utf-8")
    sys.exit("the report needs D3, version 5 or later; on Debian: apt-get install node-d3 (LIGHTWELL_D3 names another "
             "d3.min.js); looked for " + ", ".join([chosen] if chosen else D3_PLACES))


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    d3 = find_d3()
    results = Results(sys.argv[1])
    from page import write_page  # after the arguments are known to be right: matplotlib takes a second
    from plots import write_plots
    for name in write_plots(results) + [write_page(results, d3)]:
        print(results.folder / name)


if __name__ == "__main__":
    main()
