#!/usr/bin/env python3
"""Writes the measured part of docs/techniques/lpv_range.md: how far light gets by each of technique lpv's transports.

    docs/figures/lpv.py [--tests build/release/tests/lpv_test] [--measured FILE ...]

Has the test program print its figures (tags [.range_plane], [.range]; a minute or two), or takes what it printed before from
files.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/techniques/lpv_range.md"
BEGIN, END = "<!-- begin: written by docs/figures/lpv.py -->", "<!-- end -->"
CELLS = [8, 16, 32]
BOXES = ["floor", "patch", "wall"]
DARK = 3.0  # times too dark, from which on an error says nothing but "dark", and the best factor is shown beside it


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tests", default=str(ROOT / "build/release/tests/lpv_test"))
    parser.add_argument("--measured", nargs="*")
    options = parser.parse_args()
    rows = []
    for text in printed(options):
        rows += [json.loads(line[len("range "):]) for line in text.splitlines() if line.startswith("range ")]
    lines = plane([r for r in rows if r["table"] == "plane"]) + [""] + boxes([r for r in rows if r["table"] == "box"])
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(PAGE)


def printed(options):
    if options.measured:
        return [pathlib.Path(path).read_text(encoding="utf-8") for path in options.measured]
    texts = []
    for tag in ("[.range_plane]", "[.range]"):
        run = subprocess.run([options.tests, tag], check=False, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(run.stdout + run.stderr)
        texts.append(run.stdout)
    return texts


def plane(rows):
    lines = ["| | " + " | ".join(f"facing, cell {cell}" for cell in CELLS) + " | away, cell 8 |", "| --- |" + " ---: |" * 4]
    titles = {"endless": "endless, in double, {} steps", "propagate": "`propagate`, {} steps",
              "coarse_to_fine": "`coarse_to_fine`", "sweep": "`sweep`, {} directions", "truth": "truth of the square"}
    order = list(titles)
    for row in sorted(rows, key=lambda r: order.index(r["method"].split()[0])):
        name, _, count = row["method"].partition(" ")
        numbers = row["facing"] + [row["away"][0]]
        lines.append("| " + titles[name].format(count) + " | " + " | ".join(short(v) for v in numbers) + " |")
    return lines


def short(value):
    return "0" if abs(value) < 5e-4 else f"{value:.3f}" if value < 0.1 else f"{value:.2f}"


def boxes(rows):
    lines = ["| | cells | ms | " + " | ".join(BOXES) + " | in the wall's shadow |", "| --- |" + " ---: |" * 6]
    methods = list(dict.fromkeys(r["method"] for r in rows))
    for method in methods:
        for size in sorted({r["size"] for r in rows}):
            of = {r["box"]: r for r in rows if r["method"] == method and r["size"] == size}
            name, _, count = method.partition(" ")
            title = f"`{name}`" + (f", {count} " + ("directions" if name == "sweep" else "steps") if count else "")
            times = sorted(of[box]["ms"] for box in BOXES)
            wall = of["wall"]
            shadow = f"{wall['shadow'] * wall['ft'] / wall['ff'] / wall['mean']:.2g}" if wall["ff"] > 1e-24 else "dark"
            lines.append(f"| {title} | {size} | {times[1]:.1f} | " + " | ".join(error(of[box]) for box in BOXES) + f" | {shadow} |")
    return lines


def error(row):
    """Relative RMS error; of what is far too dark how much so, and the error that is left after the best factor."""
    ff, ft, tt = row["ff"], row["ft"], row["tt"]
    if ff < 1e-24:
        return "dark"
    found = math.sqrt(max(0.0, ff - 2.0 * ft + tt) / tt)
    factor = ft / ff
    if factor < DARK:
        return f"{found:.2f}"
    power = f"{factor:.0f}" if factor < 1e4 else f"{factor:.0e}".replace("e+0", "e").replace("e+", "e")
    return f"{found:.2f}; x {power}: {math.sqrt(max(0.0, 1.0 - ft * ft / (ff * tt))):.2f}"


if __name__ == "__main__":
    main()
