"""Where the error of few VPLs sits: pixels within one VPL's radius of a lit surface, against all others.

Used by rsm.py. Needs numpy, scipy and OpenEXR (PyPI) beside the command line.

A VPL drawn from texel p stands for a disc of area A_p / (N P_p). A pixel counts as near at N when some texel that
faces it (both cosines above 0.02) is closer than that disc's radius: there the bounded term cuts light off, and no
average over N brings it back.
"""
import math

PIXELS = 60000   # random pixels of the picture
TEXELS = 120000  # random texels of the RSMs
NEIGHBOURS = 192  # nearest texels tried per pixel


def near_field_lines(scenes, counts, image, aside, slope):
    """Table rows. image(scene, name): path of an EXR; aside(scene): (positions EXR, VPL file); slope(x, y)."""
    import numpy
    lines = ["| scene | pixels | " + " | ".join(map(str, counts)) + " | slope |",
             "| --- | --- | " + " | ".join(["---:"] * (len(counts) + 1)) + " |"]
    for scene in scenes:
        limit = read(image(scene, "all"))
        positions, vpls = aside(scene)
        chosen, reach = reaches(read(positions), limit["normal"], numpy.loadtxt(vpls, skiprows=1))
        mean = limit["RGB"].reshape(-1, 3)[chosen].mean()
        squared = {n: ((read(image(scene, f"flux{n}"))["RGB"] - limit["RGB"]) ** 2).mean(axis=-1).reshape(-1)[chosen]
                   for n in counts}

        def row(title, values, form="{:.4f}"):
            cells = " | ".join(form.format(v) for v in values)
            lines.append(f"| {scene} | {title} | {cells} | {slope(counts, values):+.2f} |")

        def nrmse(n, where):
            return math.sqrt(squared[n][where].mean()) / mean

        for fixed in (64, 1024):
            far = reach * math.sqrt(fixed) >= 1.0
            row(f"farther than a radius at {fixed:,} VPLs ({100 * far.mean():.0f} %)", [nrmse(n, far) for n in counts])
        row("near at N: nRMSE there", [nrmse(n, reach * math.sqrt(n) < 1.0) for n in counts])
        row("near at N: share of pixels, %", [100 * (reach * math.sqrt(n) < 1.0).mean() for n in counts], "{:.1f}")
    return lines


def read(path):
    """Layers of an EXR by name, as doubles; R, G, B together as "RGB"."""
    import numpy
    import OpenEXR
    with OpenEXR.File(str(path)) as file:
        return {name: channel.pixels.astype(numpy.float64) for name, channel in file.channels().items()}


def reaches(positions, normals, vpls):
    """Random surface pixels, and for each the least distance to a facing texel over that texel's disc radius at N = 1."""
    import numpy
    from scipy.spatial import cKDTree
    random = numpy.random.default_rng(1)
    normals = normals.reshape(-1, 3)
    points = numpy.stack([positions[plane] for plane in ("c00", "c01", "c02")], axis=-1).reshape(-1, 3)
    surfaces = numpy.flatnonzero((normals ** 2).sum(axis=1) > 0.2)
    chosen = random.choice(surfaces, min(PIXELS, len(surfaces)), replace=False)
    flux = vpls[:, 6:9].mean(axis=1)
    lit = flux > 0
    vpls, flux = vpls[lit], flux[lit]
    radius = numpy.sqrt(vpls[:, 9] * flux.sum() / flux / math.pi)
    some = random.choice(len(vpls), min(TEXELS, len(vpls)), replace=False)
    vpls, radius = vpls[some], radius[some]
    _, nearest = cKDTree(vpls[:, :3]).query(points[chosen], k=min(NEIGHBOURS, len(vpls)))
    offset = vpls[nearest][:, :, :3] - points[chosen][:, None]
    distance = numpy.maximum(numpy.linalg.norm(offset, axis=2), 1e-9)
    cosine = (offset * normals[chosen][:, None]).sum(axis=2) / distance
    vpl_cosine = -(offset * vpls[nearest][:, :, 3:6]).sum(axis=2) / distance
    facing = (cosine > 0.02) & (vpl_cosine > 0.02)
    return chosen, numpy.where(facing, distance / radius[nearest], numpy.inf).min(axis=1)
