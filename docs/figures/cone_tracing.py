#!/usr/bin/env python3
"""Makes docs/techniques/cone_tracing_figures.md and its pictures: what technique cone_tracing costs, and what it is off by.

    docs/figures/cone_tracing.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 1280x720]
                                 [--scenes cornell sponza_crytek rooms living_room] [--spp 64]
                                 [--part times errors cascades limit format pictures page] [--seconds 60]

All parts unless --part names some: `times` (of the first two scenes, at --size) wants nothing else running; the others render and judge at
480x270, on however busy a machine; `format` also runs build/release/tests/voxel_light_test; `page` writes what all have found, in this call or
before. That stays in --work (cones_*.json, a file for each part): remove a file to measure anew. After --seconds no new row is begun, and the call
ends with status 1 and how many are left: call again for those. Truths stay there, too, and are traced again only
when missing. Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES. Needs numpy and Pillow.
"""
import json
import os
import pathlib
import sys
import time

import cone_tracing_errors
import cone_tracing_page
import cone_tracing_samples
from program import caller, read_options

SIZES = [32, 64, 128, 256]
DENSE = [128, 256]
TRACED = {"anisotropic": ["interleaved", "full", "half", "quarter"], "isotropic": ["interleaved", "full", "half"], "sh2": ["interleaved", "half"]}
MEASURED = ["times", "errors", "cascades", "limit", "format", "pictures"]
TIMED = ["cornell", "sponza_crytek"]
STEP = 1 / 30  # s from frame to frame, of what moves
# The sun of the file, whose lights a scene JSON cannot move; and how far each moves in a second.
SPONZA_SUN = {"name": "sun", "kind": "sun", "direction": [0.1188, -0.9898, 0.0792], "irradiance": 10}
SPONZA_MOVED_SUN = [0.2188, -0.9758, 0.0792]
SPONZA_BOX = {"name": "crate", "box": {"lower": [-4.5, 0.2, -0.5], "upper": [-3.5, 1.2, 0.5]}, "material": "crate", "object": "moved"}


class Bench:
    """What the parts share: the program, renders, truths, and figures that are kept."""

    def __init__(self, options):
        self.options, self.call = options, caller(options.lightwell)
        self.end = time.monotonic() + float(options.seconds) if options.seconds else float("inf")

    def render(self, scene, settings, size, out=None, warmup=3, frames=1, extra=()):
        sets = [part for setting in settings for part in ("--set", setting)]
        outs = ["--out", out] if out else []
        return json.loads(self.call("render", scene, "--technique", "cone_tracing", *sets, "--size", size, "--warmup", warmup, "--frames", frames,
                                    *extra, *outs, "--json"))

    def kept(self, part):
        path = self.path(part)
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def path(self, part):
        return self.options.work / f"cones_{part}.json"

    def measure(self, part, rows):
        """rows: name to a function that measures it. Kept row by row, so that a call that was ended goes on from there."""
        found = self.kept(part)
        for name, function in rows.items():
            if name in found:
                continue
            if time.monotonic() > self.end:
                sys.exit(f"{part}: {sum(name not in found for name in rows)} rows left")
            found[name] = function()
            # Whole or not at all: the call may be ended.
            path = self.path(part)
            whole = path.with_suffix(".new")
            whole.write_text(json.dumps(found, indent=1), encoding="utf-8")
            whole.replace(path)


def main():
    options = read_options(__doc__, [*TIMED, "rooms", "living_room"], 64, parts=[*MEASURED, "page"], more=["seconds"])
    bench = Bench(options)
    if "times" in options.part:
        bench.measure("times", times(bench))
    for part in MEASURED[1:]:
        if part in options.part:
            bench.measure(part, getattr(cone_tracing_errors, part)(bench))
    if "page" in options.part:
        cone_tracing_page.write(bench, times(bench))


def times(bench):
    """Of each frame kind: the first, one at rest, one of a light that moves, one of an object that does."""
    rows = {"probe": lambda: json.loads(bench.call("devices", "--json", "--probe"))[0]}

    def add(scene, kind, *settings):
        rows[" ".join([scene, kind, *settings])] = lambda: timed(bench, scene, kind, settings)
    for scene in TIMED:
        rows[f"samples {scene}"] = lambda scene=scene: cone_tracing_samples.words_per_pixel(bench, scene)
        for mode, resolutions in TRACED.items():
            for resolution in resolutions:
                add(scene, "rest", "size=128", f"mode={mode}", f"resolution={resolution}", "cones=9")
        for size in SIZES:
            for kind in ("first", "rest", "light", "object"):
                add(scene, kind, f"size={size}")
            for kind in ("first", "light") if size in DENSE else ():
                add(scene, kind, f"size={size}", "sparse=off")
    return rows


def timed(bench, scene, kind, settings):
    moves = kind in ("light", "object")
    file = moving(bench, scene, kind) if moves else scene
    # Frames at rest and moving ones come after those that made memory for the bricks.
    warmup, frames = {"first": (0, 1), "rest": (3, 7)}.get(kind, (3, 5))
    found = bench.render(file, settings, bench.options.size, None, warmup, frames, ["--time", 1, "--step", STEP] if moves else [])
    return {"passes": {p["name"]: p["ms"] for p in found["passes"]}, "total": found["total_ms"], "counts": found["counts"],
            "bytes": found["bytes"]["device"], "device": found["device"], "load": os.getloadavg()[0]}


def moving(bench, scene, kind):
    """A scene file in which a light or an object is under way up to second 1."""
    path = bench.options.work / f"cones_{scene}_{kind}.json"
    file = next(s["path"] for s in json.loads(bench.call("scenes", "--json")) if s["name"] == scene)
    if scene == "cornell":
        text = json.loads(pathlib.Path(file).read_text(encoding="utf-8"))
        lamp = text["lights"][0]
        if kind == "light":
            lamp["keys"] = [{"time": 0, "position": lamp["position"]}, {"time": 1, "position": [0.2, 0.54, 0.2]}]
        else:
            for mesh in text["meshes"]:
                if mesh["name"].startswith("short"):
                    mesh["object"] = "moved"
            text["objects"] = [{"name": "moved", "keys": [{"time": 0}, {"time": 1, "translate": [0.1, 0, 0]}]}]
    else:
        text = {"meshes": [{"file": file}, SPONZA_BOX], "materials": {"crate": {"albedo": 0.6}}, "lights": [dict(SPONZA_SUN)]}
        keys = [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}] if kind == "object" else [{"time": 0}]
        text["objects"] = [{"name": "moved", "keys": keys}]
        if kind == "light":
            text["lights"][0]["keys"] = [{"time": 0, "direction": SPONZA_SUN["direction"]}, {"time": 1, "direction": SPONZA_MOVED_SUN}]
    path.write_text(json.dumps(text), encoding="utf-8")
    return path


if __name__ == "__main__":
    main()
