#!/usr/bin/env python3
"""Makes the figures of docs/techniques/rival.md: error against paths, with and without filter, and time.

    docs/figures/rival.py [--lightwell build/release/bin/lightwell] [--work build/figures]
                          [--size 1280x720] [--scenes cornell sponza_crytek sibenik] [--spp 64]

Writes docs/techniques/rival_figures.md. --spp: paths of the truth. Images stay in --work and are made again only when
missing. About a quarter of an hour on two cores at rest,
by the times at 320x180. Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES.
"""
import json
import math
import os

from program import ROOT, caller, read_options

PATHS = [1, 2, 4, 16, 64]
VARIANTS = [("full, raw", ["filter=off"]), ("full", []), ("half, raw", ["resolution=half", "filter=off"]),
            ("half", ["resolution=half"]), ("quarter, raw", ["resolution=quarter", "filter=off"]),
            ("quarter", ["resolution=quarter"])]


def main():
    options = read_options(__doc__, ["cornell", "sponza_crytek", "sibenik"], 64)
    work, call = options.work, caller(options.lightwell)

    cores = os.cpu_count()
    lines = ["<!-- Made by docs/figures/rival.py; do not edit. -->", ""]
    loads = []
    for scene in options.scenes:
        truth = work / f"rival_{scene}_{options.size}_{options.spp}.exr"
        if not truth.exists():
            call("reference", scene, "--bounces", 1, "--spp", options.spp, "--size", options.size, "--out", truth)
        rows, noise = {}, 0.0
        for title, settings in VARIANTS:
            for paths in PATHS:
                row, noise = measure(call, work, options, truth, scene, title, settings, paths)
                rows[title, paths] = row
                loads.append(row["load"])
        lines += table(scene, rows, noise, cores)
    lines.insert(2, f"{options.size}, one bounce, {cores} threads. **ms**: the frame's processor time over the number of threads, "
                 "of the last of three frames up to four paths, of one above (other load lengthens it less than the clock's time); load average "
                 f"{min(loads):.0f} to {max(loads):.0f}. Errors against the path-traced truth, whose own noise (relMSE) stands "
                 "beside; it is taken off what was measured (its share alike off nRMSE's square), and where it is more than "
                 "half of that no figure stands. *Slope*: of relMSE over paths, log-log, 1 to 64 (independent paths without a filter: -1).")
    lines.insert(3, "")
    out = ROOT / "docs/techniques/rival_figures.md"
    out.write_text("\n".join(lines) + "\n")
    print(out)


def measure(call, work, options, truth, scene, title, settings, paths):
    """One row, kept in a file: time, errors less the truth's noise, and the truth's noise."""
    name = f"rival_{scene}_{options.size}_{options.spp}_{title.replace(', ', '_')}_{paths}.json"
    kept = work / name
    if kept.exists():
        return tuple(json.loads(kept.read_text()))
    picture = work / f"rival_{scene}_picture.exr"
    report = json.loads(call("render", scene, "--technique", "rival", "--set", f"spp={paths}", *settings, "--size",
                             options.size, "--frames", 3 if paths <= 4 else 1, "--warmup", 0, "--out", picture, "--json"))
    milliseconds = report["counts"]["processor_us"] / 1e3 / os.cpu_count()
    errors = json.loads(call("compare", picture, truth, "--json"))
    row = {"ms": milliseconds, "relMSE": errors["relMSE"], "nrmse": errors["nrmse"],
           "bias": errors["bias"], "load": os.getloadavg()[0]}
    kept.write_text(json.dumps([row, errors["reference_noise"]]))
    return row, errors["reference_noise"]


def table(scene, rows, noise, cores):
    def error(row):
        return row["relMSE"] - noise if row["relMSE"] > 2.0 * noise else None

    def cell(row):
        left = error(row)
        if left is None:
            return f"{rounded(row['ms'])} | |"
        return f"{rounded(row['ms'])} | {left:.3g} | {row['nrmse'] * math.sqrt(left / row['relMSE']):.3g}"

    lines = [f"### {scene} (truth's noise: {noise:.2g})", "",
             "| | " + " | ".join(f"{n} path{'s' if n > 1 else ''}: ms | relMSE | nRMSE" for n in PATHS) + " | slope |",
             "| --- | " + " | ".join(["---:"] * (3 * len(PATHS) + 1)) + " |"]
    for title, _ in VARIANTS:
        points = [(n, error(rows[title, n])) for n in PATHS if error(rows[title, n]) is not None]
        slope = f"{fitted_slope(points):+.2f}" if len(points) > 2 else ""
        lines.append(f"| {title} | " + " | ".join(cell(rows[title, n]) for n in PATHS) + f" | {slope} |")
    biases = [f"{100 * rows['full, raw', n]['bias']:+.2f} %" for n in PATHS]
    return lines + ["", f"Bias of the raw picture: {', '.join(biases)}.", ""]


def rounded(value):
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


def fitted_slope(points):
    x, y = [math.log(n) for n, _ in points], [math.log(e) for _, e in points]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


if __name__ == "__main__":
    main()
