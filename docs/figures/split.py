#!/usr/bin/env python3
"""Writes the error split's part of docs/accuracy.md, and docs/images/split.svg, from what `lightwell split` measured.

    docs/figures/split.py [--results build/split] [--lightwell build/release/bin/lightwell] [split options ...]

Measures first where --results holds no split.json, with the options that follow (such as --size 320x180).
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "samples" / "chart"))
import split_section  # noqa: E402

BEGIN, END = "<!-- begin: written by docs/figures/split.py -->", "<!-- end: written by docs/figures/split.py -->"
SCENES = ["cornell", "basic", "rooms", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "wooden_staircase"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--results", default=str(ROOT / "build/split"))
    options, split_options = parser.parse_known_args()
    folder = pathlib.Path(options.results)
    if not (folder / "split.json").exists():
        command = [options.lightwell, "split", "--out", str(folder), "--scenes", *SCENES, *split_options]
        if subprocess.run(command, check=False).returncode != 0:
            sys.exit("lightwell split failed")
    data = json.loads((folder / "split.json").read_text(encoding="utf-8"))
    page = ROOT / "docs/accuracy.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + "\n".join(measured(data)) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    shutil.copy(folder / "split.svg", ROOT / "docs/images/split.svg")
    print(page)


def measured(data):
    header, points = data["header"], data["points"]
    names = list(split_section.SHARES)
    lines = [f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]}, {header['patterns']} patterns, on "
             f"{header['device']['name']}, {header['device']['width']} lanes, with `docs/figures/split.py`.", "",
             "![Shares of the error](images/split.svg)", "",
             "| view | technique | relMSE | " + " | ".join(names) + " | with exact visibility |",
             "| --- | --- | ---: | " + " | ".join(["---:"] * (len(names) + 1)) + " |"]
    for point in points:
        view, name = split_section.title(point)
        cells = [share(point, key) for key in names]
        left = point["shares"]["bounding"] + (point["shares"]["sampling"] or 0.0)
        lines.append(f"| {view} | {name} | {point['total']:.3g} | " + " | ".join(cells) + f" | {left:.3g} |")
    return lines + [""] + reading(points)


def share(point, key):
    value = point["shares"][key]
    if value is None or (key == "model" and not point["truth_of_all_bounces"]):
        return ""
    text = f"{value:+.3g}"
    return f"({text})" if key == "bounding" and not split_section.is_trusted(point) else text


def reading(points):
    """The figures in words: where each share is largest, and how much visibility is worth."""
    def gain(point):
        return point["total"] / (point["shares"]["bounding"] + (point["shares"]["sampling"] or 0.0))

    defaults = [p for p in points if p["label"].startswith("default")]
    first = [max(p["shares"], key=lambda key, p=p: p["shares"][key] or 0.0) for p in defaults]
    ruled = sum(key == "visibility" for key in first)
    best, least = max(defaults, key=gain), min(defaults, key=gain)
    hidden = [p for p in defaults if p["shares"]["model"] < 0.0]
    text = (f"With the defaults visibility is the largest share in {ruled} of {len(defaults)} views. Shadow rays and the bounces left out "
            f"would lower the relMSE {gain(best):.0f} times in {best['scene']} and {gain(least):.1f} times in {least['scene']}: more VPLs, full "
            "resolution or another bound would not.")
    if hidden:
        text += (f" In {len(hidden)} views the model's share is negative: the light that leaks through walls stands in for bounces "
                 "left out, and adding these alone makes the picture worse.")
    return [text]


if __name__ == "__main__":
    main()
