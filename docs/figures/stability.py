#!/usr/bin/env python3
"""Writes the measured part of docs/stability.md, and its pictures, from what `lightwell stability` measured.

    docs/figures/stability.py [--results build/stability] [--scene-results build/stability_scenes]
                              [--lightwell build/release/bin/lightwell] [stability options ...]

--results is of the catalogue, --scene-results of real scenes, which LIGHTWELL_SCENES must hold. Measures first where either holds
no stability.json, with the options that follow (such as --techniques rsm rival); an hour or two each where truths are not cached
yet.
"""
import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- begin: written by docs/figures/stability.py -->", "<!-- end -->"
INDICES = ["flicker", "ghost", "leak", "drift", "spike"]
# What a viewer begins to notice (docs/stability.md, "Worst frame"; flicker goes on all the time and shows from less on).
NOTICED = {"flicker": 0.05, "ghost": 1.0, "leak": 0.01, "drift": 0.1, "spike": 0.25}
FLOOR_SHARE = 0.25  # of a figure; with a larger floor it is put in brackets
PICTURES = ["thin_walls", "opening_door", "camera_pan"]
SCENES = ["cornell", "basic", "rooms", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "wooden_staircase"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--results", default=str(ROOT / "build/stability"))
    parser.add_argument("--scene-results", default=str(ROOT / "build/stability_scenes"))
    options, more = parser.parse_known_args()
    folder = pathlib.Path(options.results)
    data = obtain(options.lightwell, folder, more)
    scenes = obtain(options.lightwell, pathlib.Path(options.scene_results), ["--scenes", *SCENES, *more])
    page = ROOT / "docs/stability.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    text = "\n".join(measured(data, folder) + of_scenes(scenes))
    page.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(page)


def obtain(lightwell, folder, options):
    """What the folder holds; measured where it holds nothing."""
    if not (folder / "stability.json").exists():
        if subprocess.run([lightwell, "stability", "--out", str(folder), *options], check=False).returncode != 0:
            sys.exit("lightwell stability failed")
    return json.loads((folder / "stability.json").read_text(encoding="utf-8"))


def of_scenes(data):
    """The part on real scenes, in the order of SCENES."""
    movements = list(dict.fromkeys(s["id"].split(".")[1] for s in data["sequences"]))
    order = [f"{scene}.{movement}" for scene in SCENES for movement in movements]
    data["sequences"] = sorted((s for s in data["sequences"] if s["id"] in order), key=lambda s: order.index(s["id"]))
    lines = ["### Real scenes", "", *conditions(data), "", *summary(data), "", *table(data), ""]
    for technique in techniques(data):
        lines += technique_text(data, technique) + [""]
    return lines + samples_text(data)


def samples_text(data):
    samples = {s["id"].split(".")[0]: s["samples"] for s in data["sequences"]}
    return ["Paths per pixel of the truths: " + ", ".join(f"`{scene}` {count}" for scene, count in samples.items()) + ".", ""]


def measured(data, folder):
    lines = conditions(data) + [""] + summary(data) + [""] + table(data) + [""]
    for technique in techniques(data):
        lines += technique_text(data, technique) + [""]
    return lines + leak_text(data) + pictures(data, folder)


def techniques(data):
    return list(dict.fromkeys(r["technique"] for r in data["results"]))


def find(data, technique, sequence):
    return next((r for r in data["results"] if r["technique"] == technique and r["sequence"] == sequence), None)


def conditions(data):
    header = data["header"]
    loads = [r["load_average"] for r in data["results"]]
    device = header["device"]
    where = f"{device['name']} ({device['platform']}, {device['driver']}, width {device['width']})" if device else "the host's cores"
    return [f"Measured {header['written'][:10]} at {header['size'][0]}x{header['size'][1]}, {header['frames']} frames each, on {where}, "
            f"{header['versions']['threads']} threads; load average {min(loads):.1f} to {max(loads):.1f}, which none of these figures depends on. "
            "Each technique with its defaults, or what stands behind its name: " + ", ".join(f"`{t}`" for t in techniques(data)) + "."]


def cell(result, index):
    """A figure with its floor; in brackets where the floor says as much."""
    value, floor = result["indices"][index], result["floors"][index]
    if value is None:
        return ""
    text = short(value)
    if floor:
        text = f"{text} *{short(floor)}*"
    return f"({text})" if is_noisy(value, floor, index) else text


def is_noisy(value, floor, index):
    return floor is not None and abs(floor) > FLOOR_SHARE * max(abs(value), NOTICED[index])


def short(value):
    if value == 0.0:
        return "0"
    return f"{value:.2g}" if abs(value) < 1.0 else f"{value:.1f}"


def summary(data):
    """Of how many sequences each index would be noticed in, and the mean error: one line a technique."""
    lines = ["In how many sequences an index would be noticed, of those whose figure stands out of the noise; relMSE and absolute bias as "
             "geometric and arithmetic means over the sequences that every technique has, with light in them:", "",
             "| technique | " + " | ".join(INDICES) + " | relMSE | bias |", "| --- | " + " | ".join("---:" for _ in INDICES) + " | ---: | ---: |"]
    lit = [s["id"] for s in data["sequences"] if all(find(data, t, s["id"]) and not find(data, t, s["id"])["is_dark_truth"] for t in techniques(data))]
    for technique in techniques(data):
        cells = []
        for index in INDICES:
            some = trusted(data, technique, index)
            cells.append(f"{sum(v >= NOTICED[index] for v, _ in some)} of {len(some)}" if some else "")
        errors = [find(data, technique, s)["errors"] for s in lit]
        relmse = math.exp(sum(math.log(e["relMSE"]) for e in errors) / len(errors))
        bias = sum(abs(e["bias"]) for e in errors) / len(errors)
        lines.append(f"| {technique} | " + " | ".join(cells) + f" | {relmse:.2g} | {100 * bias:.0f} % |")
    return lines


def table(data):
    lines = ["Floors in italics; in brackets where the floor is more than a quarter of the figure and of what is noticed.", "",
             "| failure | technique | " + " | ".join(INDICES) + " | relMSE | bias | worst frame |",
             "| --- | --- | " + " | ".join("---:" for _ in INDICES) + " | ---: | ---: | --- |"]
    for sequence in data["sequences"]:
        for technique in techniques(data):
            r = find(data, technique, sequence["id"])
            if r is None:
                continue
            relmse = f"{r['errors']['relMSE']:.2g} *{r['error_floors']['relMSE']:.1g}*" if not r["is_dark_truth"] else ""
            bias = f"{100 * r['errors']['bias']:+.0f} %" if not r["is_dark_truth"] else ("exactly 0" if r["passes"] else "**light**")
            worst = f"{r['worst_frame']}, {r['worst_reason'].lower()}" if r["worst_reason"].lower() != "none" else ""
            lines.append(f"| `{sequence['id']}` | {technique} | " + " | ".join(cell(r, i) for i in INDICES) +
                         f" | {relmse} | {bias} | {worst} |")
    return lines


def trusted(data, technique, index):
    return [(r["indices"][index], r) for r in data["results"] if r["technique"] == technique and
            r["indices"][index] is not None and not is_noisy(r["indices"][index], r["floors"][index], index)]


def technique_text(data, technique):
    """What the figures say about one technique."""
    sentences = []
    for index in INDICES:
        if all(r["indices"][index] is None for r in data["results"] if r["technique"] == technique):
            continue
        some = trusted(data, technique, index)
        if not some:
            sentences.append(f"{index.capitalize()}: no sequence has a figure that stands out of the truth's noise.")
            continue
        seen = sorted((v, r["sequence"]) for v, r in some if abs(v) >= NOTICED[index])
        worst, where = max((v, r["sequence"]) for v, r in some)
        if seen:
            names = ", ".join(f"`{name}`" for _, name in reversed(seen))
            sentences.append(f"**{index.capitalize()}** would be noticed ({NOTICED[index]:g}) in {len(seen)} of {len(some)} sequences: "
                             f"{names}; most in the first, {short(worst)}.")
        else:
            sentences.append(f"{index.capitalize()} stays below what is noticed ({NOTICED[index]:g}) in all {len(some)} sequences "
                             f"that have a trusted one; most in `{where}`, {short(worst)}.")
    sentences.append(scale_sentence(data, technique))
    sentences.append(dark_sentence(data, technique))
    return [f"**{technique}.** " + " ".join(s for s in sentences if s)]


def scale_sentence(data, technique):
    base = find(data, technique, "camera_dolly")
    others = [find(data, technique, s) for s in ("scale_small", "scale_large")]
    if base is None or None in others:
        return ""
    most = max(abs(o["errors"]["relMSE"] / base["errors"]["relMSE"] - 1.0) for o in others)
    return (f"Lengths times 1/1000 and 1000 change its relMSE by at most {100 * most:.2g} %: " +
            ("it does not depend on the unit." if most < 0.01 else "**it depends on the unit.**"))


def dark_sentence(data, technique):
    dark = [r for r in data["results"] if r["technique"] == technique and r["is_dark_truth"]]
    bad = [f"`{r['sequence']}`" for r in dark if not r["passes"]]
    if not dark:
        return ""
    return f"It gives light or NaN where there must be none: {', '.join(bad)}." if bad else "Without light or surfaces it gives exactly 0."


def leak_text(data):
    """Leak against the wall's thickness."""
    sequence = next((s for s in data["sequences"] if s["id"] == "thin_walls"), None)
    if sequence is None:
        return []
    step = max(1, (len(sequence["values"]) - 1) // 6)
    frames = list(range(0, len(sequence["values"]), step))
    lines = ["Leak against the wall's thickness (`thin_walls`):", "",
             "| thickness, mm | " + " | ".join(f"{1000 * sequence['values'][f]:.3g}" for f in frames) + " |",
             "| --- | " + " | ".join("---:" for _ in frames) + " |"]
    for technique in techniques(data):
        r = find(data, technique, "thin_walls")
        if r:
            lines.append(f"| {technique} | " + " | ".join(short(r["frames"][f]["leak"]) for f in frames) + " |")
    return lines + [""]


def pictures(data, folder):
    lines = []
    for sequence in PICTURES:
        r = find(data, "rsm", sequence)
        if r is None:
            continue
        name = f"stability_{sequence}.png"
        shutil.copy(folder / r["images"]["triptych"], ROOT / "docs/images" / name)
        lines += [f"`rsm`, the worst frame of `{sequence}` ({r['worst_frame']}, by {r['worst_reason'].lower()}): ours, truth, relative error.", "",
                  f"![{sequence}](images/{name})", ""]
    return lines


if __name__ == "__main__":
    main()
