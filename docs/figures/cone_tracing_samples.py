"""How many words cones of technique cone_tracing read at a scene's pixels: what the floor of their time is made of. Used by cone_tracing.py.

The schedule is cone_gather.md's, written anew; a cone is followed to where it leaves the grid. What ends earlier, in front of a wall, or
finds no brick reads less.
"""
import math

import numpy

import exr_planes

SIZE = "160x90"
HALF_ANGLE = math.pi / 6
NINE = [(0, 0, 1), (1, 1, 1), (1, -1, 1), (-1, 1, 1), (-1, -1, 1), (1, 0, 1), (-1, 0, 1), (0, 1, 1), (0, -1, 1)]
# Words of a sample on the finest level, whose six sides show three to a cone, and above.
WORDS = {"isotropic": (3, 1), "anisotropic": (3, 3), "sh2": (3, 4)}


def steps(cosine, size):
    """(distance, level) of a cone's samples, in voxels, with the defaults of `nudge`, `step` and `distance`."""
    found, d = [], 1 / cosine
    while d <= math.sqrt(3) * size:
        found.append((d, round(math.log2(max(1.0, 2 * math.tan(HALF_ANGLE) * d)))))
        d *= 2
    return found


def words_per_pixel(bench, scene):
    """By size and mode, of all nine cones: the mean over the pixels that show a surface."""
    planes = {}
    for name, channels in (("position", 3), ("normal", 3), ("places", 1)):
        path = bench.options.work / f"cones_{name}.exr"
        bench.render(scene, ["size=128"], SIZE, None, 0, 1, ["--debug-view", f"{name}={path}"])
        planes[name] = exr_planes.read_planes(path, [f"c{i:02d}" for i in range(channels)]).reshape(-1, channels)
    lit = (planes["normal"] ** 2).sum(axis=1) > 0.5
    n, low, per_unit = planes["normal"][lit], planes["places"][:3, 0], planes["places"][3, 0]
    share = (planes["position"][lit] - low) * per_unit / 128
    t = numpy.cross(n, numpy.where(abs(n[:, :1]) < 0.7, [1.0, 0, 0], [0, 1.0, 0]))
    t /= numpy.linalg.norm(t, axis=1, keepdims=True)
    b = numpy.cross(n, t)
    found = {}
    for size in (32, 64, 128, 256):
        sums = dict.fromkeys(WORDS, 0.0)
        for cone in NINE:
            c = numpy.array(cone) / numpy.linalg.norm(cone)
            d = c[0] * t + c[1] * b + c[2] * n
            with numpy.errstate(divide="ignore", invalid="ignore"):
                out = numpy.nanmin(numpy.fmax(-share * size / d, (1 - share) * size / d), axis=1)
            for distance, level in steps(c[2], size):
                counted = float((out >= distance - 0.5 * 2 ** level).mean())
                for mode, (finest, above) in WORDS.items():
                    sums[mode] += counted * (above if level else finest)
        found[str(size)] = sums
    return {"words": found, "surfaces": float(lit.mean())}
