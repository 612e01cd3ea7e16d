"""What the scripts of technique static_vpl's figures share: the program, files of scenes and VPLs, pictures and figures that are kept."""
import json
import pathlib
import subprocess
import sys

import numpy

import exr_planes
from program import caller

LAYERS = [f"{layer}{c}" for layer in ("", "direct.", "albedo.") for c in "RGB"]


class Bench:
    def __init__(self, options):
        self.options, self.work, self.call = options, options.work, caller(options.lightwell)

    def kept(self, part):
        path = self.work / f"static_vpl_{part}.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def keep(self, part, found):
        (self.work / f"static_vpl_{part}.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
        return found

    def write(self, name, content):
        """A scene, or a file of VPLs, from its description."""
        path = self.work / f"static_vpl_{name}.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        return path

    def path_of(self, scene):
        return next(s["path"] for s in json.loads(self.call("scenes", "--json")) if s["name"] == scene)

    def place(self, scene, name, *arguments):
        """The description that `place-vpls` makes; kept."""
        path = self.work / f"static_vpl_{name}.json"
        if not path.exists():
            self.call("place-vpls", scene, "--out", path, *arguments)
        return json.loads(path.read_text(encoding="utf-8"))

    def render(self, scene, name, technique, settings=(), size=None, extra=()):
        """The EXR, the report, and what it is lit by (read_vpls); all kept."""
        exr, report, vpls = (self.work / f"static_vpl_{name}{end}" for end in (".exr", "_report.json", ".txt"))
        if not (exr.exists() and report.exists()):
            sets = [part for s in settings for part in ("--set", s)]
            run = ["--warmup", 0, "--frames", 1, "--vpls-out", vpls] if technique != "none" else []
            report.write_text(self.call("render", scene, "--technique", technique, *sets, "--size", size or self.options.size, *run, *extra,
                                        "--out", exr, "--json"), encoding="utf-8")
        return exr, json.loads(report.read_text(encoding="utf-8")), vpls

    def truth(self, scene, name, bounces, spp, size=None, extra=()):
        """The EXR with all its layers; kept."""
        exr = self.work / f"static_vpl_{name}.exr"
        if not exr.exists():
            self.call("reference", scene, "--bounces", bounces, "--spp", spp, "--size", size or self.options.size, *extra, "--out", exr)
        return exr

    def compare(self, image, truth):
        return json.loads(self.call("compare", image, truth, "--json"))


def read_vpls(path):
    """An array [VPL, position normal flux area]."""
    lines = path.read_text().splitlines()[1:]
    return numpy.array([[float(x) for x in line.split()] for line in lines]).reshape(len(lines), 10)


def green(path):
    """Irradiance, where there is a surface."""
    planes = exr_planes.read_planes(path, ("G", "albedo.G"))
    return planes[..., 0][planes[..., 1] > 0]


def with_light(source, light, out):
    """The picture `source` with other indirect light, as a file that `lightwell compare` reads."""
    planes = exr_planes.read_planes(source, LAYERS)
    planes[..., :3] = light
    exr_planes.write_planes(out, {name: planes[..., i] for i, name in enumerate(LAYERS)})
    return out


def lattice(lower, upper, spacing):
    """Points of a box, evenly, from side to side of it; an axis without width has one."""
    steps = [numpy.linspace(a, b, round(abs(b - a) / spacing) + 1) if a != b else [a] for a, b in zip(lower, upper)]
    return [[round(float(x), 4) for x in p] for p in numpy.stack(numpy.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)]


def spheres(points, radius, **more):
    return [{"center": p, "radius": radius, **more} for p in points]


def beam_area(bench, scene, name, file, moment=()):
    """The unit_area with which a phantom sends what its lamp's whole beam brings: what an author sets once, since the places around say nothing of
    the beam. Of the scene's one spot."""
    content = json.loads(pathlib.Path(scene).read_text(encoding="utf-8"))
    lamp = content["lights"][0]
    inner, outer = (numpy.cos(numpy.radians(lamp[f"{cone}_cone_degrees"])) for cone in ("inner", "outer"))
    beam = 2 * numpy.pi * ((1 - inner) + (inner - outer) / 3)  # sr: the ramp's square, over the cosine
    vpl = read_vpls(bench.render(scene, name, "static_vpl", ["variant=phantom", f"vpls_file={file}"], "32x18", moment)[2])[0]
    way = numpy.array(lamp["position"]) - vpl[:3]
    distance = numpy.linalg.norm(way)
    return float(beam * distance ** 2 / (vpl[3:6] @ way / distance) / vpl[9])


def run_in(folder, program, *arguments):
    """For commands whose results bear the names of files that they were given."""
    result = subprocess.run([str(pathlib.Path(program).resolve()), *map(str, arguments)], cwd=folder, capture_output=True, text=True)
    if result.returncode:
        sys.exit(result.stderr.strip() or f"lightwell {arguments[0]} failed")
