"""Picture and frame times of docs/viewer.md, by the viewer without a window. Crytek Sponza has to be in LIGHTWELL_SCENES.

    docs/figures/viewer.py [--lightwell build/release/bin/lightwell] [--frames 5] [--part picture page]

Needs Pillow. The viewer lies beside the program. What is written stands between the page's marks, measured.
"""
import json
import pathlib
import sys

from PIL import Image

from program import ROOT, caller, read_options, write_between

PICTURE = {"scene": "sponza_crytek", "technique": "ssvp", "set": ["clusters=64", "visibility=soft", "interleave=2", "cluster_groups=1"],
           "exposure": "4", "shadows": 4096}
TIMED = [("cornell", "rsm", []), ("cornell", "ssvp", []), ("sponza_crytek", "rsm", []), ("sponza_crytek", "ssvp", [])]
SAME_LIGHT = [("rsm", ["vpls=0", "interleave=1"]), ("horizon", [])]
COLOURS = 256  # of the picture's palette
LARGEST = 300_000
STAGES = ["gbuffer", "shadow_maps", "rsms", "direct_light", "read_back", "upload", "compose"]


def settings(words):
    return ["--set", *words] if words else []


def draw(viewer, size, work):
    """The picture that README and page show."""
    shot = work / "viewer.png"
    viewer("--headless", "--size", size, "--scene", PICTURE["scene"], "--technique", PICTURE["technique"], *settings(PICTURE["set"]),
           "--exposure", PICTURE["exposure"], "--shadow-size", PICTURE["shadows"], "--warmup", 3, "--frames", 3, "--screenshot", shot)
    target = ROOT / "docs/images/viewer.png"
    Image.open(shot).convert("RGB").quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=8, dither=Image.Dither.NONE).save(target, optimize=True)
    if target.stat().st_size > LARGEST:
        sys.exit(f"{target}: expected at most {LARGEST} bytes, got {target.stat().st_size}")


def measure(viewer, size, frames):
    rows = []
    for scene, technique, words in TIMED:
        report = json.loads(viewer("--headless", "--json", "--no-panels", "--size", size, "--scene", scene, "--technique", technique,
                                   *settings(words), "--warmup", 2, "--frames", frames))
        stages = report["stages_ms"]
        rows.append([scene, f"`{technique}`", f"{report['frame_ms']:.0f}", *(f"{stages[name]:.1f}" for name in STAGES), f"{report['lightwell_ms']:.1f}",
                     f"{sum(report['copied_bytes'].values()) / 1e6:.1f}"])
    return rows, report


def same_light(viewer, lightwell, work):
    rows = []
    for technique, words in SAME_LIGHT:
        common = ["--size", "192x108", "--rsm-size", 64, "--technique", technique, *settings(words)]
        ours, theirs = work / "viewer_ours.exr", work / "viewer_theirs.exr"
        viewer("--headless", "--no-panels", "--warmup", 0, "--scene", "cornell", *common, "--out", ours)
        lightwell("render", "cornell", "--frames", 1, "--warmup", 0, *common, "--out", theirs)
        found = json.loads(lightwell("compare", ours, theirs, "--json"))
        rows.append([f"`{technique}`", " ".join(words), f"{found['relMSE']:.1e}", f"{found['rmse']:.4f}"])
    return rows


def table(head, rows, left):
    return ["| " + " | ".join(head) + " |", "|" + " --- |" * left + " ---: |" * (len(head) - left), *("| " + " | ".join(map(str, r)) + " |" for r in rows), ""]


def main():
    options = read_options(__doc__, [], 0, parts=("picture", "page"), more=("frames",))
    viewer = caller(str(pathlib.Path(options.lightwell).with_name("lightwell-viewer")))
    lightwell = caller(options.lightwell)
    frames = int(options.frames or 5)
    if "picture" in options.part:
        draw(viewer, options.size, options.work)
    if "page" not in options.part:
        return
    light = same_light(viewer, lightwell, options.work)  # first: what comes first of all runs while the machine settles
    rows, report = measure(viewer, options.size, frames)
    lines = [f"Milliseconds of a frame at {options.size}, medians of {frames}; OpenGL by {report['opengl']['renderer']}, OpenCL by {report['lightwell']['platform']} "
             f"({report['lightwell']['device']}): both on the same few cores, where drawing costs far more than on any GPU.", "",
             *table(["scene", "technique", "frame", *(f"`{name}`" for name in STAGES), "`lightwell`", "MB copied"], rows, 2),
             "Cornell box, rasterised inputs against ray-cast ones; relMSE of irradiance, rmse of the tone-mapped picture (edges of shadows):", "",
             *table(["technique", "parameters", "relMSE", "rmse"], light, 2)]
    write_between(ROOT / "docs/viewer.md", "<!-- figures -->", "<!-- /figures -->", lines[:-1])


main()
