#!/usr/bin/env python3
"""Makes the table of fast settings of docs/techniques/cone_tracing_fast.md: what nine cones take and are off by, by where they are traced and between
how many voxels they are interpolated.

    docs/figures/cone_tracing_fast.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 1280x720]
                                      [--scenes cornell living_room sponza_crytek] [--spp 64] [--part times errors pictures page] [--calls 2] [--seconds 60]

`times` wants nothing else running: each of its rows is the lowest median of 15 frames of --calls calls, one after the other; `errors` judges at 480x270 against
one bounce of light, on however busy a machine; `page` writes what both have found. That stays in --work (cones_fast_*.json): remove a file to measure
anew. After --seconds no new row is begun. Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES.
"""
import os
import sys

from cone_tracing import Bench
from cone_tracing_errors import SIZE, judged, truth
from program import ROOT, read_options, write_between
from thesis_pictures import composite, encode, exposure_of, signed

NINE = ["size=128", "cones=9", "mode=isotropic", "normal_aware=off"]
DEFAULT = ["size=64", "cones=16"]
RESOLUTIONS = ["interleaved", "half", "half_interleaved"]
INTERPOLATIONS = ["trilinear", "tetrahedral"]
# ms: nine cones of isotropic voxels at 128 a side and 1280x720, with all that makes of them the picture's light.
AIMS = {"interleaved": 18, "half": 26, "half_interleaved": 26}
PICTURED = ["cornell", "sponza_crytek"]
SHOWN = [["resolution=interleaved", "interpolation=trilinear"], ["resolution=half_interleaved", "interpolation=trilinear"],
         ["resolution=half_interleaved", "interpolation=tetrahedral"]]
MAP_WIDTH = 320  # of one picture
PAGE = ROOT / "docs/techniques/cone_tracing_fast.md"
BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"


def settings():
    return [[*base, f"resolution={r}", f"interpolation={i}"] for base in (NINE, DEFAULT) for r in RESOLUTIONS for i in INTERPOLATIONS]


def timed(bench, scene, sets):
    found = bench.render(scene, sets, bench.options.size, None, 3, 15)
    traced = [p for p in found["passes"] if p["name"].startswith(("cone_gather.", "joint_bilateral."))]
    return {"trace": sum(p["ms"] for p in traced if p["name"] == "cone_gather.trace"), "all": sum(p["ms"] for p in traced), "device": found["device"],
            "load": os.getloadavg()[0]}


def rows(bench):
    calls = range(int(bench.options.calls or 2))
    times = {" ".join([f"call={k}", scene, *sets]): lambda scene=scene, sets=sets: timed(bench, scene, sets)
             for k in calls for scene in bench.options.scenes for sets in settings()}
    errors = {" ".join([scene, *sets]): lambda scene=scene, sets=sets: judged(bench, scene, sets, "fast")
              for scene in bench.options.scenes for sets in settings()}
    return times, errors


def main():
    options = read_options(__doc__, ["cornell", "living_room", "sponza_crytek"], 64, parts=["times", "errors", "pictures", "page"], more=["calls", "seconds"])
    bench = Bench(options)
    times, errors = rows(bench)
    if "times" in options.part:
        bench.measure("fast_times", times)
    if "errors" in options.part:
        bench.measure("fast_errors", errors)
    if "pictures" in options.part:
        bench.measure("fast_pictures", {scene: lambda scene=scene: picture(bench, scene) for scene in PICTURED})
    if "page" in options.part:
        write(bench)


def write(bench):
    times, errors = bench.kept("fast_times"), bench.kept("fast_errors")
    if not times or not errors:
        sys.exit("nothing measured yet: --part times errors")
    scenes = bench.options.scenes
    first = next(iter(times.values()))
    calls = 1 + max(int(key.split()[0][5:]) for key in times)
    lines = [f"{first['device']}; {bench.options.size}; medians of 15 frames, of {calls} calls the lowest (in others one of two cores was another",
             "program's): the cones' trace, and with all that makes the picture's light of it, milliseconds. Errors: relMSE / nRMSE / bias against one bounce, 480x270."]
    for title, base in ((f"`{' '.join(NINE)}`", NINE), (f"`{' '.join(DEFAULT)}`, the defaults", DEFAULT)):
        lines += ["", title + ":", "", "| | " + " | ".join(f"{scene}: trace, all | error" for scene in scenes) + " |",
                  "| --- |" + " ---: | ---: |" * len(scenes)]
        for sets in settings():
            if sets[:len(base)] == base:
                name = f"`{sets[-2].split('=')[1]}`, {sets[-1].split('=')[1]}"
                lines.append(f"| {name} | " + " | ".join(cell(times, errors, scene, sets) for scene in scenes) + " |")
    shown = ", ".join("`" + "`, ".join(part.split("=")[1] for part in sets) for sets in SHOWN)
    lines += ["", f"The defaults' pictures: truth, then {shown}; below, on the screen's scale,", "red where too bright and blue where too dark, full at a quarter of its range.", ""]
    for name in bench.kept("fast_pictures").values():
        lines += [f"![{name[len('cone_tracing_fast_'):-4]}](../images/{name})", ""]
    write_between(PAGE, BEGIN, END, ["", *lines])
    for resolution, aim in AIMS.items():
        for interpolation in INTERPOLATIONS:
            sets = [*NINE, f"resolution={resolution}", f"interpolation={interpolation}"]
            print(resolution, interpolation, "aim", aim, {scene: [round(row["all"], 1) for row in calls_of(times, scene, sets)] for scene in scenes})


def picture(bench, scene):
    """Truth and results; below, what they are off by on the screen's scale."""
    import numpy
    from PIL import Image

    light = composite(truth(bench, scene))
    exposure = exposure_of(light)
    reference, screens = encode(exposure * light), []
    for sets in SHOWN:
        path = bench.options.work / f"cones_{scene}_fast.exr"
        bench.render(scene, [*DEFAULT, *sets], SIZE, path)
        screens.append(encode(exposure * composite(path)))
    upper = numpy.hstack([reference, *screens])
    lower = numpy.hstack([numpy.full_like(reference, 0.5), *(signed(screen - reference) for screen in screens)])
    image = Image.fromarray((255 * numpy.vstack([upper, lower]).clip(0, 1) + 0.5).astype(numpy.uint8))
    height = round(2 * MAP_WIDTH * reference.shape[0] / reference.shape[1])
    name = f"cone_tracing_fast_{scene}.jpg"
    image.resize(((1 + len(SHOWN)) * MAP_WIDTH, height), Image.Resampling.LANCZOS).save(ROOT / "docs/images" / name, quality=85)
    return name


def calls_of(times, scene, sets):
    name = " ".join([scene, *sets])
    return [row for key, row in times.items() if key.split(" ", 1)[1] == name]


def cell(times, errors, scene, sets):
    found, error = calls_of(times, scene, sets), errors[" ".join([scene, *sets])]
    best = min(found, key=lambda row: row["all"])
    return f"{best['trace']:.1f}, {best['all']:.1f} | {error['relMSE']:.3g} / {error['nrmse']:.2f} / {100 * error['bias']:+.0f} %"


if __name__ == "__main__":
    main()
