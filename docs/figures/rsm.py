#!/usr/bin/env python3
"""Makes the figures of docs/techniques/rsm.md: limit, convergence, invariance and time of technique rsm.

    docs/figures/rsm.py [--lightwell build/release/bin/lightwell] [--work build/figures]
                        [--size 1280x720] [--scenes cornell sibenik sponza_crytek] [--spp 16]

Writes docs/techniques/rsm_figures.md. Images stay in --work and are made again only when missing.
Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES.
"""
import json
import math
import os

import near_field
from program import ROOT, caller, read_options

COUNTS = [64, 256, 1024, 4096, 16384]


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_crytek"], 16)
    work, call = options.work, caller(options.lightwell)

    def render(scene, name, *settings, frames=1, warmup=0, extra=()):
        """Renders once per name; returns (EXR, the report)."""
        exr, report = work / f"{scene}_{name}.exr", work / f"{scene}_{name}.json"
        if not (exr.exists() and report.exists()):
            sets = [part for setting in settings for part in ("--set", setting)]
            text = call("render", scene, "--technique", "rsm", *sets, "--size", options.size, "--frames", frames,
                        "--warmup", warmup, "--out", exr, "--json", *extra)
            report.write_text(json.dumps({**json.loads(text), "load_average": os.getloadavg()[0]}))
        return exr, json.loads(report.read_text())

    def compare(image, reference):
        return json.loads(call("compare", image, reference, "--json"))

    lines = [f"<!-- Made by docs/figures/rsm.py; do not edit. -->", ""]
    lines += limit_tables(options, work, call, render, compare)
    lines += near_field_table(options, work, call, render)
    lines += invariance_table(options, render, compare)
    lines += time_table(options, work, call, render)
    out = ROOT / "docs/techniques/rsm_figures.md"
    out.write_text("\n".join(lines) + "\n")
    print(out)


def limit_tables(options, work, call, render, compare):
    """nRMSE against all texels by number of VPLs; bias against the path-traced limit without visibility."""
    lines = [f"### Error against the number of VPLs ({options.size}, one RSM of 512^2, interleave 1)", "",
             "nRMSE against the picture of all texels; bias against the unshadowed one-bounce path-traced "
             f"reference ({options.spp} paths per pixel).", "",
             "| scene | sampling | " + " | ".join(map(str, COUNTS)) + " | slope | bias at 4,096 | bias of all texels |",
             "| --- | --- | " + " | ".join(["---:"] * (len(COUNTS) + 3)) + " |"]
    for scene in options.scenes:
        reference = work / f"{scene}_unshadowed.exr"
        if not reference.exists():
            call("reference", scene, "--bounces", 1, "--unshadowed", "--spp", options.spp, "--size", options.size,
                 "--out", reference)
        limit, _ = render(scene, "all", "vpls=0", "interleave=1")
        limit_bias = compare(limit, reference)["bias"]
        for sampling in ("flux", "uniform"):
            images = {n: render(scene, f"{sampling}{n}", f"vpls={n}", "interleave=1", f"sampling={sampling}")[0]
                      for n in COUNTS}
            errors = [compare(images[n], limit)["nrmse"] for n in COUNTS]
            slope = fitted_slope(COUNTS, errors)
            bias = compare(images[4096], reference)["bias"]
            lines.append(f"| {scene} | {sampling} | " + " | ".join(f"{e:.4f}" for e in errors) +
                         f" | {slope:+.2f} | {100 * bias:+.2f} % | {100 * limit_bias:+.2f} % |")
        pairs = [[render(scene, f"seed{seed}n{n}", f"vpls={n}", "interleave=1", f"seed={seed}")[0] for seed in (1, 2)]
                 for n in COUNTS]
        errors = [compare(*pair)["nrmse"] / math.sqrt(2.0) for pair in pairs]
        lines.append(f"| {scene} | flux, sampling alone | " + " | ".join(f"{e:.4f}" for e in errors) +
                     f" | {fitted_slope(COUNTS, errors):+.2f} | | |")
    return lines + ["", "*Sampling alone*: nRMSE between two seeds, over the root of two: what bounding takes from every "
                    "picture alike is left out.", ""]


def near_field_table(options, work, call, render):
    """Slopes with the pixels set aside that a VPL's own disc reaches."""
    def aside(scene):
        positions, vpls = work / f"{scene}_position.exr", work / f"{scene}_all.vpls"
        if not (positions.exists() and vpls.exists()):
            call("render", scene, "--technique", "rsm", "--set", "vpls=64", "--set", "interleave=1", "--size",
                 options.size, "--frames", 1, "--debug-view", f"position={positions}", "--out", work / "unused.exr")
            call("render", scene, "--technique", "rsm", "--set", "vpls=0", "--set", "interleave=1", "--size", "32x18",
                 "--frames", 1, "--vpls-out", vpls, "--out", work / "unused.exr")
        return positions, vpls

    def image(scene, name):
        return work / f"{scene}_{name}.exr"

    return ["### Where the error sits", "",
            "nRMSE against all texels, flux sampling. *Near*: closer to a facing lit texel than the radius of the disc "
            "that its VPL stands for at that N; there the bounded term cuts light off. All other pixels converge.", "",
            *near_field.near_field_lines(options.scenes, COUNTS, image, aside, fitted_slope), ""]


def fitted_slope(counts, errors):
    x, y = [math.log(c) for c in counts], [math.log(e) for e in errors]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def invariance_table(options, render, compare):
    """Ten runs give one hash; scales change the picture by rounding only, powers of two not at all."""
    scene = options.scenes[-1]
    hashes = {render(scene, f"run{i}")[1]["hash"] for i in range(10)}
    lines = ["### Same input, same bits", "",
             f"{scene}, defaults, ten processes: {len(hashes)} hash{'es' if len(hashes) > 1 else ''} "
             f"({', '.join(sorted(hashes))}).", "",
             "Lengths scaled, lights with them so that irradiance stays. A power of two scales without rounding, from "
             "the scene's file to the picture. Other factors round the rays: texels at edges change surface, and single "
             "VPLs with them.", "",
             "| scene | x 8 | x 1/8 | x 10, nRMSE | x 0.1, nRMSE |", "| --- | --- | --- | ---: | ---: |"]
    for scene in options.scenes:
        plain, report = render(scene, "scale1", extra=("--hash",))
        scaled = {k: render(scene, f"scale{k}", extra=("--scale", k, "--hash")) for k in ("8", "0.125", "10", "0.1")}
        same = ["same bits" if scaled[k][1]["hash"] == report["hash"] else "differs" for k in ("8", "0.125")]
        errors = [f"{compare(scaled[k][0], plain)['nrmse']:.1e}" for k in ("10", "0.1")]
        lines.append(f"| {scene} | " + " | ".join(same + errors) + " |")
    return lines + [""]


def time_table(options, work, call, render):
    """Milliseconds of every pass, medians; share of the probed multiply-add rate for the gather."""
    scene = options.scenes[-1]
    variants = [("256 VPLs, 4x4, filter (default)", []), ("256 VPLs per pixel", ["interleave=1"]),
                ("256 VPLs, 4x4, half resolution", ["resolution=half"]),
                ("1,024 VPLs, 4x4, filter", ["vpls=1024"])]
    reports = [render(scene, "time" + "".join(s).replace("=", ""), *s, frames=31, warmup=5)[1] for _, s in variants]
    names = list(dict.fromkeys(p["name"] for r in reports for p in r["passes"]))
    width, height = map(int, options.size.split("x"))
    lines = [f"### Time ({scene}, {options.size}, one RSM of 512^2; median of 31 frames, ms)", "",
             f"{reports[0]['device']}, {reports[0]['platform']} {reports[0]['driver']}, {reports[0]['width']} lanes; "
             f"load average {max(r['load_average'] for r in reports):.1f} at most.", "",
             "| pass | " + " | ".join(title for title, _ in variants) + " |",
              "| --- | " + " | ".join(["---:"] * len(variants)) + " |"]
    for name in names:
        cells = [next((f"{p['ms']:.2f}" for p in r["passes"] if p["name"] == name), "") for r in reports]
        lines.append(f"| `{name}` | " + " | ".join(cells) + " |")
    lines.append("| **total** | " + " | ".join(f"**{r['total_ms']:.2f}**" for r in reports) + " |")
    gather = next(p["ms"] for p in reports[1]["passes"] if p["name"] == "interleaved_gather.gather")
    rate = width * height * 256 * 33 / gather / 1e6
    probe_file = work / "probe.json"  # of the same minutes as the times: a busy machine slows both
    if not probe_file.exists():
        probe_file.write_text(call("devices", "--probe", "--json"))
    probe = json.loads(probe_file.read_text())[0]["multiply_add_gflops"]
    share = f", {100 * rate / probe:.0f} % of the {probe:.0f} GF/s that the device's probe reaches"
    return lines + ["", f"The 256-VPL gather runs at {rate:.0f} GF/s, counting 33 operations per pair of pixel and VPL{share}; pairs that tiles skip are counted, as they are answered.", ""]


if __name__ == "__main__":
    main()
