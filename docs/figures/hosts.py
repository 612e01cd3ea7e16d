#!/usr/bin/env python3
"""Writes the measured part of docs/hosts.md and its pictures: frames of Blender and Mitsuba 3 lit by `lightwell gi`, against these programs' own light.

    docs/figures/hosts.py [--lightwell build/release/bin/lightwell] [--frames build/hosts] [--work build/figures]

Needs what docs/hosts/blender.py and docs/hosts/mitsuba3.py have left in FRAMES/blender and FRAMES/mitsuba (scenes empty, spot, sun, sphere).
Pictures in WORK are made again only where they are missing.
"""
import argparse
import json
import math
import pathlib
import sys

from program import ROOT, caller, write_between

sys.path.insert(0, str(ROOT / "docs" / "hosts"))
sys.path.insert(0, str(ROOT / "tests" / "cli"))
import exr  # noqa: E402
import room  # noqa: E402

BEGIN, END = "<!-- begin: written by docs/figures/hosts.py -->", "<!-- end -->"
PROGRAMS = {"blender": "Blender 3.4, Cycles", "mitsuba": "Mitsuba 3.9"}
SCENES = {"empty": "room without blocks, spot", "spot": "room, spot", "sun": "room, sun"}
CONVEX = "empty"  # nothing hides anything there: a gather without visibility has the truth
# Technique, setting, the truth that holds as many bounces as it knows of.
SETTINGS = [("rsm", "", "one"), ("rsm", "vpls=0 interleave=1 filter=off", "one"), ("rsm", "visibility=voxel", "one"), ("ssvp", "bounces=1", "one"),
            ("ssvp", "bounces=1 vpls=1024 clusters=64", "one"), ("lpv", "", "one"), ("cone_tracing", "", "one"), ("screen_space", "", "one"),
            ("ssvp", "bounces=2", "all"), ("ssvp", "bounces=4 vpls=1024 clusters=64", "all")]
PICTURED = ("ssvp", "bounces=4 vpls=1024 clusters=64", "all")
BOUNCES = {"one": "one", "all": "all"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--frames", type=pathlib.Path, default=ROOT / "build/hosts")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/figures")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    call = caller(options.lightwell)
    lines = ["", *sphere_table(options, call), *spot_falloff(options), *error_tables(options, call), *agreement(options, call)]
    write_between(ROOT / "docs/hosts.md", BEGIN, END, lines)


def gi(options, call, program, scene, technique, sets, out, *more):
    name = options.frames / program / scene
    maps = [f"{name}_rsm{i}.exr" for i in range(6)] if scene == "sphere" else [f"{name}_rsm.exr"]
    setting = ["--set", *sets.split()] if sets else []
    more = [*more, "--two-sided"] if program == "mitsuba" and scene == "sun" else more  # the outer sides of its walls
    if out.exists():
        return out
    call("gi", "--gbuffer", f"{name}.exr", "--camera", f"{name}_camera.json", "--rsm", *maps, "--light", f"{name}_light.json",
         "--technique", technique, *setting, *more, "--out", out)
    return out


def truth(options, call, program, scene, bounces):
    name = options.frames / program / f"{scene}_{bounces}"
    return gi(options, call, program, scene, "truth", "", options.work / f"{program}_{scene}_{bounces}.exr", "--truth", f"{name}_a.exr", f"{name}_b.exr")


def mean(planes, names, factor=1.0):
    values = [value for name in names for value in planes[name]]
    return factor * sum(values) / len(values)


def sphere_table(options, call):
    """Inside a sphere everything is known."""
    direct = room.SPHERE["intensity"] / room.SPHERE["radius"] ** 2
    rho = room.SPHERE["reflectance"]
    known = [direct, rho * direct, rho / (1 - rho) * direct]
    lines = ["### A case that is known", "",
             f"Inside a sphere of radius R = {room.SPHERE['radius']} m and reflectance rho = {rho} with a lamp of I = {room.SPHERE['intensity']} W/sr in its middle the "
             "direct irradiance is I / R^2", "everywhere, one indirect bounce brings rho times that, all of them rho / (1 - rho) times. Means over the picture, in W/m^2:", "",
             "| | direct | one bounce | all |", "| --- | ---: | ---: | ---: |", "| known | " + " | ".join(f"{value:.4f}" for value in known) + " |"]
    for program, title in PROGRAMS.items():
        one, every = (exr.read(truth(options, call, program, "sphere", bounces))[2] for bounces in ("one", "all"))
        own = [mean(one, ["direct.R"], math.pi / rho), mean(one, ["R"]), mean(every, ["R"])]
        lines.append(f"| {title}, its own | " + " | ".join(f"{value:.4f}" for value in own) + " |")
        ours = gi(options, call, program, "sphere", "rsm", "vpls=0 interleave=1 filter=off", options.work / f"{program}_sphere_rsm.exr")
        lines.append(f"| its frame, `rsm` of all texels | | {mean(exr.read(ours)[2], ['R']):.4f} | |")
    return [*lines, ""]


def spot_falloff(options):
    """What Blender's spot sends towards each pixel that it lights, by its own DiffDir: E = I c / d^2."""
    planes = exr.read(options.frames / "blender" / "spot.exr")[2]
    eye, axis = room.SPOT["position"], room.unit(room.minus(room.SPOT["target"], room.SPOT["position"]))
    along = []
    for i, radiance in enumerate(planes["ViewLayer.DiffDir.R"]):
        way = room.minus([planes["ViewLayer.Position." + c][i] for c in "XYZ"], eye)
        squared, normal = sum(p * p for p in way), [planes["ViewLayer.Normal." + c][i] for c in "XYZ"]
        cosine = -sum(p * q for p, q in zip(way, normal)) / math.sqrt(squared)
        if radiance > 0.0 and cosine > 0.05:
            along.append((math.pi * radiance * squared / cosine, sum(p * q for p, q in zip(way, axis)) / math.sqrt(squared)))
    intensities, ratios = [i for i, _ in along], [i / c for i, c in along]
    return ["### Blender's spot", "",
            f"Its power is 4 pi x {room.SPOT['intensity'][0]:.0f} W. Towards the {len(along)} pixels that it lights in the room it sends {min(intensities):.3f} to "
            f"{max(intensities):.3f} W/sr;", f"divided by the cosine of the angle to its axis, {min(ratios):.4f} to {max(ratios):.4f} W/sr.", ""]


def error_tables(options, call):
    lines = ["### Against the programs' own light", "",
             "The truth holds one indirect bounce where a technique models one, else all. Its own noise (relMSE) stands above each table; figures that are not "
             "ten times as", "large say little.", ""]
    for scene, title in SCENES.items():
        for program, program_title in PROGRAMS.items():
            truths = {bounces: truth(options, call, program, scene, bounces) for bounces in BOUNCES}
            rows, noise = [], {}
            for technique, sets, bounces in SETTINGS:
                name = f"{program}_{scene}_{technique}_{sets}".replace(" ", "_").replace("=", "")
                out = gi(options, call, program, scene, technique, sets, options.work / f"{name}.exr")
                errors = json.loads(call("compare", out, truths[bounces], "--json"))
                noise[bounces] = errors["reference_noise"]
                rows.append(f"| `{technique}`{' ' + sets if sets else ''} | {BOUNCES[bounces]} | {errors['relMSE']:.3f} | {errors['nrmse']:.3f} | {100 * errors['bias']:+.1f} % |")
                if (technique, sets, bounces) == PICTURED and scene != CONVEX:
                    call("triptych", out, truths[bounces], "--out", ROOT / f"docs/images/hosts_{program}_{scene}.png")
            lines += [f"#### {program_title}: {title}", ""]
            if scene != CONVEX:
                lines += [f"![direct light only, with Lightwell's {PICTURED[0]}, the program's own light](images/hosts_{program}_{scene}.png)", "",
                          f"*Direct light only | with `{PICTURED[0]}` {PICTURED[1]} | all light by {program_title}.*", ""]
            lines += [f"Noise of the truth: {noise['one']:.1e} of one bounce, {noise['all']:.1e} of all.", "",
                      "| technique | bounces of the truth | relMSE | nRMSE | bias |", "| --- | --- | ---: | ---: | ---: |", *rows, ""]
    return lines


def agreement(options, call):
    """The sun's room has the same lamp in both programs."""
    lines = ["### The two programs against each other", "",
             "In the sun's room both have the same lamp (Blender's spot falls off with the cosine to its axis, Mitsuba's does not). Mitsuba's light against "
             "Blender's:", "",
             "| truth | relMSE | bias | noise of Blender's |", "| --- | ---: | ---: | ---: |"]
    for bounces, title in BOUNCES.items():
        files = [truth(options, call, program, "sun", bounces) for program in ("mitsuba", "blender")]
        errors = json.loads(call("compare", *files, "--json"))
        lines.append(f"| {title} | {errors['relMSE']:.2e} | {100 * errors['bias']:+.2f} % | {errors['reference_noise']:.2e} |")
    return lines


if __name__ == "__main__":
    main()
