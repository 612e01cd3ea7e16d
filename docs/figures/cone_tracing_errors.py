"""Errors of technique cone_tracing against path tracing, the limit, the format of its words, and pictures. Used by cone_tracing.py."""
import json
import pathlib
import re
import subprocess
import sys

import exr_planes
from program import ROOT
from thesis_pictures import composite, encode, exposure_of, signed

SIZE = "480x270"
# Scenes whose paths cost little: so many times the paths, for errors that are smaller there.
EASY = {"cornell": 8, "rooms": 8}
SETTINGS = ([[f"size={size}"] for size in (32, 64, 128, 256)] +
            [[f"size={size}", f"mode={mode}"] for mode in ("isotropic", "sh2") for size in (64, 128)] +
            [["size=128", f"cones={cones}"] for cones in (6, 16, 64)] +
            [["size=128", f"resolution={resolution}"] for resolution in ("full", "half", "quarter")] +
            [["size=64", "normal_aware=off"]])
CASCADES = [(size, cascades) for size in (32, 64) for cascades in (1, 2, 3, 4)]
LIMIT_SIZES, LIMIT_CONES, LIMIT = [32, 64, 128, 256], [9, 64, 256], ["resolution=full", "step=0.5"]
# What may be left at the limit, one at a time: where cones begin, and the side that larger voxels show.
LIMIT_MORE = [["size=128", "cones=64", "nudge=0.5"], ["size=128", "cones=64", "nudge=2"], ["size=128", "cones=64", "mode=isotropic"],
              ["size=128", "cones=64", "directional_opacity=on"], ["size=128", "cones=64", "step=0.25"]]
# Lamps so many times as bright: not powers of two, so that every word's mantissa is another.
BRIGHTER = [1.0, 1.13, 1.29, 1.47, 1.68]
PICTURED = ["cornell", "sponza_crytek", "living_room"]
PICTURE = ["size=128"]
MAP_WIDTH = 426  # of one picture; lightwell compare's colours are not used, as too bright and too dark should be told apart


def truth(bench, scene):
    path = bench.options.work / f"cones_truth_{scene}.exr"
    if not path.exists():
        bench.call("reference", scene, "--bounces", 1, "--spp", bench.options.spp * EASY.get(scene, 1), "--size", SIZE, "--compact", "--out", path)
    return path


def judged(bench, scene, settings, name="picture"):
    picture = bench.options.work / f"cones_{scene}_{name}.exr"
    found = bench.render(scene, settings, SIZE, picture)
    return {**compared(bench, picture, truth(bench, scene)), "counts": found["counts"]}


def compared(bench, picture, reference):
    return json.loads(bench.call("compare", picture, reference, "--json"))


def errors(bench):
    return {" ".join([scene, *settings]): lambda scene=scene, settings=settings: judged(bench, scene, settings)
            for settings in SETTINGS for scene in bench.options.scenes}


def cascades(bench):
    return {f"size={size} cascades={count}": lambda size=size, count=count: judged(bench, "sponza_crytek", [f"size={size}", f"cascades={count}"])
            for size, count in CASCADES}


def limit(bench):
    rows = {}
    for size in LIMIT_SIZES:
        for cones in LIMIT_CONES:
            settings = [f"size={size}", f"cones={cones}"]
            rows[" ".join(settings)] = lambda settings=settings: judged(bench, "cornell", [*settings, *LIMIT], "_".join(settings))
    for more in LIMIT_MORE:
        # The last of a key counts.
        rows[" ".join(more)] = lambda more=more: judged(bench, "cornell", [*LIMIT, *more], "more")

    def difference(one, other):
        return compared(bench, *(bench.options.work / f"cones_cornell_size={size}_cones={cones}.exr" for size, cones in (one, other)))
    for cones in LIMIT_CONES[:-1]:
        rows[f"cones {cones}"] = lambda cones=cones: difference((LIMIT_SIZES[-1], cones), (LIMIT_SIZES[-1], LIMIT_CONES[-1]))
    for size in LIMIT_SIZES[:-1]:
        rows[f"size {size}"] = lambda size=size: difference((size, LIMIT_CONES[-1]), (LIMIT_SIZES[-1], LIMIT_CONES[-1]))
    return rows


def format(bench):  # noqa: A001 (the part's name)
    rows = {"test": lambda: word_test(bench)}
    rows["cornell"] = lambda: brighter(bench, PICTURE)
    return rows


def word_test(bench):
    """relative RMS and worst error of points' irradiance, words against floats: of a room of one light and of one with contrasts of 10^4."""
    program = pathlib.Path(bench.options.lightwell).resolve().parents[1] / "tests/voxel_light_test"
    run = subprocess.run([program, "words lose less*", "-s"], capture_output=True, text=True, check=False)
    if run.returncode:
        sys.exit(run.stdout + run.stderr)
    found = {}
    for is_even, block in zip(("contrast", "even"), re.split(r"isEven := (?:true|1)", run.stdout)):
        found[is_even] = {key: float(re.search(pattern + r" := ([0-9.e+-]+)", block)[1])
                          for key, pattern in (("rms", r"squares\) / mean"), ("worst", r"worst / mean"))}
    return found


def brighter(bench, settings):
    """The same picture by lamps of several brightnesses, each over its own: what differs is rounding."""
    import numpy

    shipped = next(s["path"] for s in json.loads(bench.call("scenes", "--json")) if s["name"] == "cornell")
    scene = json.loads(pathlib.Path(shipped).read_text(encoding="utf-8"))
    intensity, planes = scene["lights"][0]["intensity"], []
    for factor in BRIGHTER:
        scene["lights"][0]["intensity"] = intensity * factor
        file, picture = bench.options.work / "cones_brighter_scene.json", bench.options.work / "cones_brighter.exr"
        file.write_text(json.dumps(scene), encoding="utf-8")
        bench.render(file, settings, SIZE, picture)
        planes.append(exr_planes.read_planes(picture) / factor)
    planes = numpy.array(planes)
    mean, spread = planes.mean(), planes.std(axis=0, ddof=1)
    means = planes.mean(axis=(1, 2, 3)) / mean
    return {"rms": float(numpy.sqrt((spread ** 2).mean()) / mean), "mean": float(abs(means - 1).max()),
            "relative": float(numpy.sqrt((spread ** 2 / (planes.mean(axis=0) ** 2 + 0.01 * mean ** 2)).mean()))}


def pictures(bench):
    return {scene: lambda scene=scene: picture(bench, scene) for scene in PICTURED}


def picture(bench, scene):
    """Truth, result, and what it is off by on the screen's scale."""
    import numpy
    from PIL import Image

    path = bench.options.work / f"cones_{scene}_shown.exr"
    bench.render(scene, PICTURE, SIZE, path)
    light = composite(truth(bench, scene))
    exposure = exposure_of(light)
    reference, screen = encode(exposure * light), encode(exposure * composite(path))
    row = numpy.hstack([reference, screen, signed(screen - reference)])
    image = Image.fromarray((255 * row.clip(0, 1) + 0.5).astype(numpy.uint8))
    height = round(MAP_WIDTH * reference.shape[0] / reference.shape[1])
    name = f"cone_tracing_{scene}.jpg"
    image.resize((3 * MAP_WIDTH, height), Image.Resampling.LANCZOS).save(ROOT / "docs/images" / name, quality=85)
    return name
