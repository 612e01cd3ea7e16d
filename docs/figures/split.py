#!/usr/bin/env python3
"""Writes the error split's part of docs/accuracy.md, and docs/images/split.svg, from what `lightwell split` measured.

    docs/figures/split.py [--results build/split] [--lightwell build/release/bin/lightwell] [split options ...]

Measures first where --results holds no split.json, with the options that follow (such as --size 320x180); then, into
--results/visibility, the share of visibility in two scenes as they are and with every albedo 0.6.
"""
import argparse
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "samples" / "chart"))
import split_section  # noqa: E402

BEGIN, END = "<!-- begin: written by docs/figures/split.py -->", "<!-- end: written by docs/figures/split.py -->"
SCENES = ["cornell", "basic", "rooms", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "wooden_staircase"]
# The conditions of an earlier experiment with exact rays, whose relMSE was 76 and 9.4 without visibility, 0.13 and
# 0.10 with it: 320x180, every albedo 0.6, 256 uniform VPLs.
GREY_SCENES = ["living_room", "sponza_crytek"]
GREY_ALBEDO = 0.6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--results", default=str(ROOT / "build/split"))
    options, split_options = parser.parse_known_args()
    folder = pathlib.Path(options.results)
    if not (folder / "split.json").exists():
        scenes = [] if "--scenes" in split_options else ["--scenes", *SCENES]
        command = [options.lightwell, "split", "--out", str(folder), *scenes, *split_options]
        if subprocess.run(command, check=False).returncode != 0:
            sys.exit("lightwell split failed")
    data = json.loads((folder / "split.json").read_text(encoding="utf-8"))
    grey = visibility(options.lightwell, folder / "visibility")
    page = ROOT / "docs/accuracy.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + "\n".join(measured(data) + [""] + visibility_table(grey)) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    shutil.copy(folder / "split.svg", ROOT / "docs/images/split.svg")
    print(page)


def visibility(lightwell, folder):
    """split.json of GREY_SCENES as they are and grey, 256 VPLs, every pixel."""
    folder.mkdir(exist_ok=True)
    scenes = []
    for name in GREY_SCENES:
        grey = folder / f"{name}_grey.glb"
        if not grey.exists():
            write_grey(pathlib.Path(os.environ["LIGHTWELL_SCENES"]) / f"{name}.glb", grey)
        scenes += [name, str(grey)]
    if not (folder / "done").exists():
        command = [lightwell, "split", "--out", str(folder), "--scenes", *scenes, "--techniques", "rsm", "--cameras", "first",
                   "--size", "320x180", "--only", "vpls=256", "interleave=1", "resolution=full", "--no-all-bounces", "--noise", "5e-3",
                   "--truth-seconds", "120", "--no-report"]
        if subprocess.run(command, check=False).returncode != 0:
            sys.exit("lightwell split failed")
        (folder / "done").touch()
    return json.loads((folder / "split.json").read_text(encoding="utf-8"))


def write_grey(source, target):
    """A copy of a binary glTF with one albedo everywhere; masks keep their textures' holes."""
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    scene, rest = json.loads(data[20:20 + length]), data[20 + length:]
    for material in scene["materials"]:
        if material.get("alphaMode") == "BLEND":
            continue
        surface = material.setdefault("pbrMetallicRoughness", {})
        surface["baseColorFactor"], surface["metallicFactor"] = [GREY_ALBEDO] * 3 + [1.0], 0.0
        if material.get("alphaMode") != "MASK":
            surface.pop("baseColorTexture", None)
        material["name"] = material.get("name", "").replace("[metal]", "")
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    target.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") +
                       text + rest)


def visibility_table(data):
    lines = ["What visibility alone is worth, at 320x180 with 256 VPLs for every pixel, against one bounce (an earlier experiment, every "
             "albedo 0.6 and uniform VPLs, had 76 and 9.4 without it, 0.13 and 0.10 with it in the living room and Sponza; its RSM was "
             "fitted otherwise, and where few VPLs fall through the windows the sampling decides what is left):", "",
             "| scene | sampling | VPLs that are lit | without visibility | with it | of that sampling | truth's noise |",
             "| --- | --- | ---: | ---: | ---: | ---: | ---: |"]
    for point in data["points"]:
        shares = point["shares"]
        lines.append(f"| {point['scene'].replace('_grey', ', every albedo 0.6')} | {point['parameters']['sampling']} | {point['vpls']} | "
                     f"{point['total']:.3g} | {left_text(point)} | {shares['sampling']:.3g} | "
                     f"{point['noise']:.1e} |")
    return lines


def measured(data):
    header, (points, _) = data["header"], split_section.current(data)
    names = list(split_section.SHARES)
    lines = [f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]}, {header['patterns']} patterns, on "
             f"{header['device']['name']}, {header['device']['width']} lanes, with `docs/figures/split.py`"
             + (". Truth: all bounces." if any(p["truth_of_all_bounces"] for p in points) else
                ". Truth: as many bounces as the technique models, so without the model's share."), "",
             "![Shares of the error](images/split.svg)", "",
             "| view | technique | relMSE | " + " | ".join(names) + " | with exact visibility |",
             "| --- | --- | ---: | " + " | ".join(["---:"] * (len(names) + 1)) + " |"]
    for point in points:
        view, name = split_section.title(point)
        cells = [split_section.figure_text(point, key) for key in ["total", *names]]
        lines.append(f"| {view} | {name} | " + " | ".join(cells) + f" | {left_text(point)} |")
    return lines + [""] + reading(points)


def visible(point):
    """The error that is left with exact visibility, and whether the truth's noise leaves it to be told."""
    left = point["shares"]["bounding"] + (point["shares"]["sampling"] or 0.0)
    return left, split_section.is_trusted(point, "visibility exact", left)


def left_text(point):
    left, is_trusted = visible(point)
    return f"{left:.3g}" if is_trusted else f"({left:.3g})"


def reading(points):
    """The figures in words: where each share is largest, and how much visibility is worth."""
    def gain(point):
        """At least: no less is left than the truth's noise lets tell."""
        return point["total"] / max(visible(point)[0], point["noise"] / split_section.TRUSTED)

    def times(point, form):
        return f"{'' if visible(point)[1] else 'at least '}{gain(point):{form}} times in {point['scene']}"

    defaults = [p for p in points if p["label"].startswith("default")]
    if not defaults:
        return []
    first = [max(p["shares"], key=lambda key, p=p: p["shares"][key] or 0.0) for p in defaults]
    ruled = sum(key == "visibility" for key in first)
    best, least = max(defaults, key=gain), min(defaults, key=gain)
    modelled = any(p["truth_of_all_bounces"] for p in defaults)
    hidden = [p for p in defaults if p["shares"]["model"] < 0.0]
    text = (f"With the defaults visibility is the largest share in {ruled} of {len(defaults)} views. Shadow rays from every pixel to every VPL{' and the bounces left out' if modelled else ''} "
            f"would lower the relMSE {times(best, '.0f')} and {times(least, '.1f')}.")
    if ruled == len(defaults):
        text += " More VPLs, full resolution or another bound would not."
    if hidden:
        text += (f" In {len(hidden)} views the model's share is negative: the light that leaks through walls stands in for bounces "
                 "left out, and adding these alone makes the picture worse.")
    return [text]


if __name__ == "__main__":
    main()
