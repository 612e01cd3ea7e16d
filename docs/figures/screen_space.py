#!/usr/bin/env python3
"""Makes the figures of docs/techniques/screen_space.md: the times and errors of the settings of its paper, and the share of
time that each level takes.

    docs/figures/screen_space.py [--lightwell build/release/bin/lightwell] [--work build/figures]
                                 [--size 1280x720] [--scenes cornell sibenik sponza_crytek] [--spp 16]

Writes docs/techniques/screen_space_figures.md. Images stay in --work and are made again only when missing.
Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES.
"""
import json
import os

from program import ROOT, caller, read_options

# Soler et al. 2009, fig. 6: setting, and the totals that they give for a GTX 260 and an 8800 GTS.
SETTINGS = [("quarter", 4, 64, 4.6, 13.9), ("quarter", 4, 256, 11.2, 33.6), ("half", 4, 64, 10.5, 34.8),
            ("half", 4, 256, 32.6, 110.6), ("half", 5, 64, 10.55, 35.1)]


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_crytek"], 16)
    work, call = options.work, caller(options.lightwell)

    def render(scene, *settings, extra=()):
        """Renders once per set of settings; returns (EXR, the report)."""
        name = "screen_" + scene + "_" + "_".join(settings).replace("=", "")
        exr, report = work / f"{name}.exr", work / f"{name}.json"
        if not (exr.exists() and report.exists()):
            sets = [part for setting in settings for part in ("--set", setting)]
            text = call("render", scene, "--technique", "screen_space", *sets, "--size", options.size, "--frames", 15,
                        "--warmup", 3, "--out", exr, "--json", *extra)
            report.write_text(json.dumps({**json.loads(text), "load_average": os.getloadavg()[0]}))
        return exr, json.loads(report.read_text())

    def reference(scene):
        exr = work / f"{scene}_bounce1.exr"
        if not exr.exists():
            call("reference", scene, "--bounces", 1, "--spp", options.spp, "--size", options.size, "--out", exr)
        return exr

    lines = ["<!-- Made by docs/figures/screen_space.py; do not edit. -->", ""]
    lines += settings_table(options, call, render, reference)
    lines += level_table(options, render)
    out = ROOT / "docs/techniques/screen_space_figures.md"
    out.write_text("\n".join(lines) + "\n")
    print(out)


def sets_of(setting):
    start, levels, samples, *_ = setting
    return f"start={start}", f"levels={levels}", f"samples={samples}"


def milliseconds(report, *prefixes):
    return sum(p["ms"] for p in report["passes"] if p["name"].startswith(prefixes))


def settings_table(options, call, render, reference):
    """Times of the paper's five settings by step, and their errors against one-bounce truth."""
    scene = options.scenes[-1]
    reports = [render(scene, *sets_of(s))[1] for s in SETTINGS]
    lines = [f"### The paper's settings ({scene}, {options.size}; median of 15 frames, ms)", "",
             f"{reports[0]['device']}, {reports[0]['platform']} {reports[0]['driver']}, {reports[0]['width']} lanes; load average "
             f"{max(r['load_average'] for r in reports):.1f} at most. The paper's totals: GTX 260 / 8800 GTS.", "",
             "| start, levels, samples | pyramid | gather | combine | total | paper's total | " +
             " | ".join(f"relMSE, {s}" for s in options.scenes) + " |",
             "| --- |" + " ---: |" * (5 + len(options.scenes))]
    for setting, report in zip(SETTINGS, reports):
        errors = [json.loads(call("compare", render(s, *sets_of(setting))[0], reference(s), "--json"))["relMSE"]
                  for s in options.scenes]
        lines.append(f"| {setting[0]}, {setting[1]}, {setting[2]} | {milliseconds(report, 'mip_pyramid'):.2f} | "
                     f"{milliseconds(report, 'screen_gather'):.2f} | {milliseconds(report, 'screen_combine'):.2f} | "
                     f"{report['total_ms']:.2f} | {setting[3]} / {setting[4]} | " + " | ".join(f"{e:.3g}" for e in errors) + " |")
    return lines + [""]


def level_table(options, render):
    """Gather time by level, of half resolution with five levels (the paper's fig. 7 has half, 64 samples)."""
    report = render(options.scenes[-1], *sets_of(SETTINGS[4]))[1]
    levels = [(n, milliseconds(report, f"screen_gather.level{n}")) for n in range(1, 6)]
    total = sum(ms for _, ms in levels)
    return [f"### Gather by level ({options.scenes[-1]}, half, 5 levels, 64 samples)", "", "| level | ms | share |",
            "| ---: | ---: | ---: |"] + [f"| {n} | {ms:.2f} | {100 * ms / total:.0f} % |" for n, ms in levels] + [""]


if __name__ == "__main__":
    main()
