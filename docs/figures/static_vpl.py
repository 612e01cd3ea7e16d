#!/usr/bin/env python3
"""Makes the measured part of docs/techniques/static_vpl_figures.md, and its pictures: what technique static_vpl is right and wrong about.

    docs/figures/static_vpl.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 480x270] [--spp 64]
                               [--part first door road flip studs block flicker stereo page]

All parts unless --part names some; `page` writes what all have found, in this call or before. That stays in --work (static_vpl_*: a JSON file for
each part, with the pictures that it is made of): remove files to measure anew. Only `stereo` wants nothing else running; it runs lightwell_bench of
the same build. Crytek's Sponza is looked for in LIGHTWELL_SCENES. Needs numpy, matplotlib and Pillow.
"""
import json
import pathlib
import subprocess
import sys

import static_vpl_door
import static_vpl_first
import static_vpl_flicker
import static_vpl_flip
import static_vpl_page
import static_vpl_weak
from program import ROOT, read_options, write_between
from static_vpl_bench import Bench

PART = "<!-- {} {}: figures of docs/figures/static_vpl.py -->"
PAGE = ROOT / "docs/techniques/static_vpl_figures.md"


def stereo(bench):
    """Medians of lightwell_bench, microseconds."""
    found = bench.kept("stereo")
    if found:
        return found
    program = pathlib.Path(bench.options.lightwell).parents[1] / "tests/lightwell_bench"
    result = subprocess.run([program, "--benchmark_filter=static_vpl.eyes", "--benchmark_format=json", "--benchmark_repetitions=9", "--benchmark_enable_random_interleaving=true",
                             "--benchmark_min_time=0.2"], capture_output=True, text=True)
    if result.returncode:
        sys.exit(result.stderr.strip() or "lightwell_bench failed")
    runs = json.loads(result.stdout)["benchmarks"]
    return bench.keep("stereo", {r["run_name"].split("/")[0].split(".")[-1]: r["real_time"] for r in runs if r.get("aggregate_name") == "median"})


# What measures a part, and what writes it.
PARTS = {"first": (static_vpl_first.first, static_vpl_page.first), "door": (static_vpl_door.door, static_vpl_page.door),
         "road": (static_vpl_door.road, static_vpl_page.road), "flip": (static_vpl_flip.flip, static_vpl_page.flip),
         "studs": (static_vpl_weak.studs, static_vpl_page.studs), "block": (static_vpl_weak.block, static_vpl_page.block),
         "flicker": (static_vpl_flicker.flicker, static_vpl_page.flicker), "stereo": (stereo, static_vpl_page.stereo)}

PICTURED = ("first", "flip", "block")  # whose pictures the page needs beside the figures; they are kept, too


def main():
    options = read_options(__doc__, [], 64, "480x270", parts=(*PARTS, "page"))
    bench = Bench(options)
    for part, (measure, write) in PARTS.items():
        if part not in options.part and not bench.kept(part):
            continue
        found = measure(bench) if part in options.part or part in PICTURED else bench.kept(part)
        if "page" in options.part:
            lines = write(*found) if isinstance(found, tuple) else write(found)
            write_between(PAGE, PART.format("begin", part), PART.format("end", part), lines)


if __name__ == "__main__":
    main()
