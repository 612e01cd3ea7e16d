#!/usr/bin/env python3
"""What a frame takes whatever its light: the passes around the gather, each against the time that its bytes take at the device's bandwidth.
Writes the table between the marks of docs/performance.md.

    docs/figures/fixed.py [--scenes rooms] [--frames 25]
"""
import json

import program

PAGE = program.ROOT / "docs/performance.md"
BEGIN, END = "<!-- figures: fixed.py -->", "<!-- end of figures -->"
# Planes of float of a picture's size that a pass reads and writes once each, by setting: position and normal are 3 each, irradiance 3,
# validity 1, marks a bit each; half resolution counts a quarter, and of down-sampling's rows every second is not
# read; repaired are one pixel in 32 at most, and counted alone although they come in lines of 16. Taps that caches hold are not counted again.
TEXELS = 512 * 512  # of the RSM, 9 floats in and 10 out each
PLANES = {"rsm resolution=half": {"rsm_input.unpack": None, "joint_bilateral.downsample": (3, 1.5), "interleaved_gather.bounds": (1.5, 0), "interleaved_gather.gather": (1.5, 0.75),
                                  "interleaved_gather.filter": (2.25, 0.75), "joint_bilateral.upsample": (8.25, 4)},
          "rsm": {"interleaved_gather.bounds": (6, 0), "interleaved_gather.gather": (6, 3), "interleaved_gather.filter": (9, 4)},
          "rsm auto_resolution=0.5": {"joint_bilateral.downsample": (3, 1.5), "interleaved_gather.filter": (2.25, 0.75),
                                      "joint_bilateral.upsample": (8.25, 4), "pixel_repair.collect": (6 / 32, 7 / 32)}}


def main():
    options = program.read_options(__doc__, ["rooms"], 0, more=("frames",))
    call = program.caller(options.lightwell)
    rates = json.loads(call("devices", "--probe", "--json"))[0]
    width, height = map(int, options.size.split("x"))
    megabytes = 4e-6 * width * height  # of a plane
    lines = ["| setting | pass | ms | MB read and written | ms at the device's bandwidth |", "| --- | --- | ---: | ---: | ---: |"]
    for setting, passes in PLANES.items():
        technique, *values = setting.split()
        frame = json.loads(call("render", options.scenes[0], "--technique", technique, *(["--set", *values] if values else []), "--size", options.size,
                                "--frames", options.frames or 25, "--json"))
        times = {p["name"]: p["ms"] for p in frame["passes"]}
        for name, planes in passes.items():
            moved = sum(planes) * megabytes if planes else TEXELS * 19 * 4e-6
            lines.append(f"| `{setting}` | `{name}` | {times[name]:.2f} | {moved:.0f} | {moved / rates['bandwidth_GBps']:.2f} |")
        lines.append(f"| `{setting}` | the frame | {frame['total_ms']:.1f} | | |")
    lines += ["", f"`{options.scenes[0]}` at {options.size} on {rates['name']}, {rates['compute_units']} cores, {rates['bandwidth_GBps']:.0f} GB/s and "
                  f"{rates['multiply_add_gflops']:.0f} Gflop/s by its probe; medians of {options.frames or 25} frames at rest."]
    program.write_between(PAGE, BEGIN, END, lines)


if __name__ == "__main__":
    main()
