#!/usr/bin/env python3
"""Writes the tables of docs/techniques/ssvp_visibility.md, and their pictures, from what `lightwell visibility` counts (--part page), and the
page's picture of strict and careful look-ups (--part gallery, in seconds).

    docs/figures/ssvp_visibility.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--part page gallery]
                                    [--size 320x180] [--scenes cornell sibenik sponza_crytek living_room]

Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. What has been counted lies in --work and is kept: remove it
to count anew. Of these options the gallery heeds the first two.
"""
import json
import os
import pathlib
import shutil

from program import ROOT, caller, read_options
from split import GREY_ALBEDO, write_grey

CLUSTERS, SIDES = [4, 8, 16, 32, 64, 0], [64, 128, 256, 512]
SOURCES, SOURCE_CLUSTERS, SOURCE_SIDES = ["triangles", "surfels", "screen"], [8, 32], [128, 256]
BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"
SOFT_SIDE, OTHERS = 128, ["soft", "strict"]
# The set-up of an earlier experiment, with what it found: relMSE in Crytek Sponza's first camera and the living room.
GREY_SCENES = ["sponza_crytek", "living_room"]
GREY_CLUSTERS = [8, 32, 64]
EARLIER = {("none", 0): (9.4, 76), ("exact", 0): (0.097, 0.129),
           ("medoid", 8): (0.41, 0.41), ("medoid", 32): (0.23, 0.17), ("medoid", 64): (0.20, 0.22),
           ("mean", 8): (0.44, 2.9), ("mean", 32): (0.37, 33), ("mean", 64): (0.45, 38),
           ("map 256 soft", 8): (0.46, 0.75), ("map 256 soft", 32): (0.29, 1.5)}
GREY_NOISE, GREY_SECONDS = "5e-3", "150"
# Crytek Sponza's gallery: four bounces, the last two without shadows.
GALLERY = ["sponza_crytek", "--camera", "suggested_camera_2", "--size", "640x360", "--technique", "ssvp",
           "--set", "vpls=1024", "clusters=64", "bounces=4", "resolution=half"]
GALLERY_WAYS, GAP = ["strict", "careful"], 4  # pixels of white between the two


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_crytek", "living_room"], 0, "320x180", parts=("page", "gallery"))
    call = caller(options.lightwell)
    if "page" in options.part:
        write_page(options, call)
    if "gallery" in options.part:
        gallery(options, call)


def write_page(options, call):
    def count(name, scene, *arguments):
        kept = options.work / f"visibility_{name}.json"
        if not kept.exists():
            kept.write_text(call("visibility", scene, "--size", options.size, "--json", *arguments), encoding="utf-8")
        return json.loads(kept.read_text(encoding="utf-8"))

    lines = [f"One pixel of each 4 x 4 at {options.size}, 256 VPLs by flux, one bounce; false light / false shadow in per cent *of pairs* and *of light* "
             "(each pair weighed by what it would bring with nothing between), and the relMSE against a ray for each pair. N: every VPL its own "
             "cluster. *mean*, *medoid*: rays to the clusters' means and medoids. Numbers: the side of a hard map; other look-ups by name.", ""]
    for scene in options.scenes:
        lines += sweep_table(scene, lambda name, *arguments, s=scene: count(name, s, "--no-truth", *arguments))
    lines += sources_table(options.scenes, count)
    lines += grey_table(options, count) + pictures(options, call)
    page = ROOT / "docs/techniques/ssvp_visibility.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(page)


def sets(settings):
    return [part for setting in settings for part in ("--set", setting)]


def sweep(key, values):
    return ["--sweep", f"{key}=" + ",".join(map(str, values))]


def sweep_table(scene, count):
    hard = count(f"{scene}_triangles", *sweep("clusters", CLUSTERS), *sweep("map_size", SIDES))
    others = {way: count(f"{scene}_triangles_{way}", *sets([f"map_size={SOFT_SIDE}", f"visibility={way}"]), *sweep("clusters", CLUSTERS)) for way in OTHERS}
    by_place = {(p["parameters"]["clusters"], p["parameters"]["map_size"]): p for p in hard["points"]}
    others = [{p["parameters"]["clusters"]: p for p in found["points"]} for found in others.values()]
    none = next(iter(by_place.values()))
    lines = [f"### {scene}, maps of triangles", "",
             f"{none['pairs']:,} pairs. With nothing between judged lit, {share(none, 'none', '')} % of pairs are false light, {share(none, 'none', '_weighted')} % of "
             f"light; relMSE {error(none, 'none')}.", "",
             "| clusters | what | mean | medoid | " + " | ".join(map(str, SIDES)) + "".join(f" | {SOFT_SIDE} {way}" for way in OTHERS) + " |",
             "| ---: | --- | " + " | ".join(["---:"] * (len(SIDES) + 2 + len(OTHERS))) + " |"]
    for clusters in CLUSTERS:
        points = [by_place[clusters, side] for side in SIDES]
        cells = [(points[0], "mean"), (points[0], "medoid"), *((p, "map") for p in points), *((other[clusters], "map") for other in others)]
        rows = {"of pairs": [both(p, way, "") for p, way in cells], "of light": [both(p, way, "_weighted") for p, way in cells],
                "relMSE": [error(p, way) for p, way in cells]}
        for what, row in rows.items():
            lines.append(f"| {clusters or 'N'} | {what} | " + " | ".join(row) + " |")
    return lines + [""]


def sources_table(scenes, count):
    lines = ["### What maps are drawn from", "", "As above; false light / false shadow in per cent of light, and the relMSE against a ray for each pair. *triangles*: "
             "exact; *surfels*: the same triangles, sampled; *screen*: the texels of the shadow map and the pixels of the view.", "",
             "| scene | clusters | side | " + " | ".join(f"{source} | relMSE" for source in SOURCES) + " | medoids' rays |",
             "| --- | ---: | ---: | " + " | ".join(["---: | ---:"] * len(SOURCES)) + " | ---: |"]
    for scene in scenes:
        found = count(f"{scene}_sources", scene, "--no-truth", *sweep("occluders", SOURCES), *sweep("clusters", SOURCE_CLUSTERS),
                      *sweep("map_size", SOURCE_SIDES))
        by_place = {(p["parameters"]["clusters"], p["parameters"]["map_size"], p["parameters"]["occluders"]): p for p in found["points"]}
        for clusters in SOURCE_CLUSTERS:
            for side in SOURCE_SIDES:
                points = [by_place[clusters, side, source] for source in SOURCES]
                cells = " | ".join(f"{both(p, 'map', '_weighted')} | {error(p, 'map')}" for p in points)
                lines.append(f"| {scene} | {clusters} | {side} | {cells} | {error(points[0], 'medoid')} |")
    return lines + [""]


def share(point, way, suffix, kind="false_light"):
    return f"{100 * point['misjudged'][way][kind + suffix]:.1f}"


def both(point, way, suffix):
    return share(point, way, suffix) + " / " + share(point, way, suffix, "false_shadow")


def error(point, way):
    return f"{point['error_against_exact_rays'][way]['relMSE']:.2g}"


def grey_table(options, count):
    found = {}
    for scene in GREY_SCENES:
        grey = options.work / f"{scene}_grey.glb"
        if not grey.exists():
            write_grey(pathlib.Path(os.environ["LIGHTWELL_SCENES"]) / f"{scene}.glb", grey)
        found[scene] = count(f"{scene}_grey", grey, "--judge-one-of", "1", "--noise", GREY_NOISE, "--truth-seconds", GREY_SECONDS,
                             *sets(["sampling=uniform"]), *sweep("visibility", ["hard", "soft"]), *sweep("map_size", [256, 512]),
                             *sweep("clusters", GREY_CLUSTERS))
    noise = " and ".join(f"{found[scene]['truth']['noise']:.1e}" for scene in GREY_SCENES)
    lines = ["### An earlier experiment's set-up", "",
             f"{options.size}, every albedo {GREY_ALBEDO}, one sun, 256 uniform VPLs, every pixel, against one bounce by path tracing (relMSE of the truths: "
             f"{noise}); relMSE / nRMSE / bias, and *ratio*, the relMSE over that of rays to the medoids. *earlier*: relMSE of the experiment, whose RSM was fitted otherwise.",
             "", "| visibility | clusters | " + " | ".join(f"{scene} | ratio | earlier" for scene in GREY_SCENES) + " |",
             "| --- | ---: | " + " | ".join(["---: | ---: | ---:"] * len(GREY_SCENES)) + " |"]
    rows = [("none", 0), ("exact", 0)] + [(way, k) for way in ("medoid", "mean") for k in GREY_CLUSTERS]
    rows += [(f"map {side} {kind}", k) for side in (256, 512) for kind in ("soft", "hard") for k in GREY_CLUSTERS]
    for way, clusters in rows:
        cells = []
        for i, scene in enumerate(GREY_SCENES):
            of = grey_errors(found[scene], way, clusters)
            medoid = grey_errors(found[scene], "medoid", clusters)["relMSE"] if clusters else 0.0
            ratio = f"{of['relMSE'] / medoid:.2f}" if way.startswith("map") else ""
            earlier = EARLIER.get((way, clusters))
            cells.append(f"{of['relMSE']:.3g} / {of['nrmse']:.2f} / {100 * of['bias']:+.0f} % | {ratio} | {'' if earlier is None else earlier[i]}")
        lines.append(f"| {way} | {clusters or ''} | " + " | ".join(cells) + " |")
    return lines + [""]


def grey_errors(found, way, clusters):
    """The errors of "none", "exact", "medoid", "mean", or "map SIDE KIND"."""
    kind, side = ("hard", 256) if not way.startswith("map") else (way.split()[2], int(way.split()[1]))
    for point in found["points"]:
        of = point["parameters"]
        if of["visibility"] == kind and of["map_size"] == side and clusters in (0, of["clusters"]):
            return point["error"][way.split()[0]]
    raise KeyError((way, clusters))


def pictures(options, call):
    lines = ["### Where", "", "Misjudged light over the pixel's own (as relMSE weighs it), black 0, white 1 and more; 32 clusters, defaults else. Left to right: the "
             "map's false light and false shadow, those of rays to the medoids.", ""]
    for scene in GREY_SCENES:
        name = f"ssvp_misjudged_{scene}.png"
        picture = options.work / name
        call("visibility", scene, "--size", options.size, "--judge-one-of", "1", "--no-truth", "--set", "clusters=32", "--out", picture)
        shutil.copy(picture, ROOT / "docs/images" / name)
        lines.append(f"![{scene}](../images/{name})")
    return lines


def gallery(options, call):
    """Both at the exposure of the first: by its own, a picture that is black in part would be brighter elsewhere."""
    import numpy
    from PIL import Image

    exposure, shown = [], []
    for way in GALLERY_WAYS:
        picture = options.work / f"ssvp_gallery_{way}.png"
        report = json.loads(call("render", *GALLERY, f"visibility={way}", "--json", "--out", picture, *exposure))
        exposure = ["--exposure", report["exposure"]]
        shown.append(numpy.asarray(Image.open(picture).convert("RGB")))
    gap = numpy.full((shown[0].shape[0], GAP, 3), 255, numpy.uint8)
    out = ROOT / "docs/images/ssvp_careful.jpg"
    Image.fromarray(numpy.hstack([shown[0], gap, shown[1]])).save(out, quality=85)
    print(out)


if __name__ == "__main__":
    main()
