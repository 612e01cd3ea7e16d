#!/usr/bin/env python3
"""Makes docs/techniques/screen_space_figures.md and its pictures: figures 4 to 9 of Soler et al. 2009, measured here.

    docs/figures/screen_space.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 640x360]
                                 [--scenes cornell sponza_crytek] [--spp 32]
                                 [--part levels slices settings starts cameras times page]

--size is that of the pictures that are judged; times are those of 1280x720. All parts unless --part names some: `times` takes under
90 seconds and wants nothing else running; the others render and judge, on however busy a machine, scene by scene; `page` writes what
all of them found, in this call or before, which --work keeps. Truths stay there and are traced again only when missing. Scenes other
than the shipped ones are looked for in LIGHTWELL_SCENES. Needs numpy and matplotlib.
"""
import json
import os

import screen_space_page
from program import ROOT, caller, read_options

# Soler et al. 2009, fig. 6: setting, and the totals that they give for a GTX 260 and an 8800 GTS.
SETTINGS = [("quarter", 4, 64, 4.6, 13.9), ("quarter", 4, 256, 11.2, 33.6), ("half", 4, 64, 10.5, 34.8),
            ("half", 4, 256, 32.6, 110.6), ("half", 5, 64, 10.55, 35.1)]
# Fig. 8: levels such that all reach equally far, 1280 pixels of a picture of 720 rows.
STARTS = {"quarter": 4, "half": 5, "full": 6}
SAMPLES = [16, 32, 64, 256]
TIMED_SCENE, TIMED_SIZE = "cornell", "1280x720"
SLICE_SIZE = "720x720"
PARTS = ["levels", "slices", "settings", "starts", "cameras"]
EASY = {"cornell": 2}  # scenes whose paths cost little: so many times the paths, for errors that are smaller there
# Fig. 5: its radius of 40 texels; where the first level starts is not said there.
SLICE = ["start=half", "levels=4", "samples=64", "radius=40"]
SLICE_ROW = 0.62  # of the height, from above: across both side walls and, in the Cornell box, the tall block
# Fig. 9: a picture that misses the light which another camera sees. Scene: camera, the other camera.
# (Crytek Sponza's other cameras show next to nothing that its first one does not.)
CAMERAS = {"cornell": [("front", "inside")]}
ON_SCREEN = ["screen, no shadows", "screen"]
TRUTHS = {"screen, no shadows": ["--on-screen", "--unshadowed"], "screen": ["--on-screen"], "all": []}


class Bench:
    """What the figures share: renders of the technique, truths, comparisons."""

    def __init__(self, options):
        self.options, self.call = options, caller(options.lightwell)
        # Each frame alone, where the technique has a history: the paper's figures are taken without.
        self.plain = []
        known = self.render("cornell", [], "64x64", "known")[1]["parameters"]
        if "history" in known:
            self.plain = ["history=0"]

    def render(self, scene, settings, size, name="picture", frames=1, warmup=0, extra=()):
        exr = self.options.work / f"screen_{name}.exr"
        sets = [part for setting in [*self.plain, *settings] for part in ("--set", setting)]
        text = self.call("render", scene, "--technique", "screen_space", *sets, "--size", size, "--frames", frames, "--warmup",
                         warmup, "--rsm-size", 16, "--out", exr, "--json", *extra)
        return exr, json.loads(text)

    def paths(self, scene):
        return self.options.spp * EASY.get(scene, 1)

    def truth(self, scene, kind, size, extra=()):
        spp = self.paths(scene)
        name = "_".join(["truth", scene, kind.replace(", ", "_").replace(" ", "_"), size, f"{spp}spp",
                         *(word.strip("-") for word in extra)])
        exr = self.options.work / f"{name}.exr"
        if not exr.exists():
            self.call("reference", scene, "--bounces", 1, *TRUTHS[kind], "--spp", spp, "--size", size, "--compact",
                      "--out", exr, *extra)
        return exr

    def errors(self, exr, truth):
        found = json.loads(self.call("compare", exr, truth, "--json"))
        return {key: found[key] for key in ("relMSE", "nrmse", "bias", "p99", "reference_noise")}


def main():
    options = read_options(__doc__, ["cornell", "sponza_crytek"], 32, "640x360", parts=(*PARTS, "times", "page"))
    kept = options.work / "screen_space_figures.json"
    found = json.loads(kept.read_text()) if kept.exists() else {}
    bench = Bench(options) if set(options.part) - {"page"} else None
    makers = {"levels": level_pictures, "slices": slices, "settings": setting_errors, "starts": start_errors, "cameras": camera_errors}
    for part in [p for p in PARTS if p in options.part]:
        for scene in options.scenes:
            found.setdefault(part, {})[scene] = makers[part](bench, scene)
            found.setdefault("spp", {})[scene] = bench.paths(scene)
            found["size"] = options.size
            kept.write_text(json.dumps(found))
    if "times" in options.part:
        found["times"] = times(bench)
        kept.write_text(json.dumps(found))
    if "page" in options.part:
        screen_space_page.write(found, ROOT, SETTINGS, STARTS, SLICE, SLICE_SIZE)


def sets_of(setting):
    start, levels, samples, *_ = setting
    return [f"start={start}", f"levels={levels}", f"samples={samples}"]


def level_pictures(bench, scene):
    """Fig. 4: a level's light is what it adds to the picture of the levels before it: up-sampling and adding are linear."""
    count = 4
    pictures = [bench.render(scene, [f"levels={n}"], bench.options.size, f"{scene}_levels{n}")[0] for n in range(1, count + 1)]
    return screen_space_page.draw_levels(pictures, ROOT / f"docs/images/screen_space_levels_{scene}.png")


def slices(bench, scene):
    """Fig. 5: bounded, unbounded and the truths, along a row, and their errors."""
    pictures = {name: bench.render(scene, [*SLICE, f"bounded={bounded}"], SLICE_SIZE, name)[0]
                for name, bounded in (("bounded", "on"), ("unbounded", "off"))}
    truths = {kind: bench.truth(scene, kind, SLICE_SIZE) for kind in ON_SCREEN}
    screen_space_page.draw_slices(pictures, truths, SLICE_ROW, ROOT / f"docs/images/screen_space_slices_{scene}.svg")
    return [{"form": name, "errors": {kind: bench.errors(exr, truth) for kind, truth in truths.items()},
             "largest": screen_space_page.largest(exr) / screen_space_page.largest(truths["screen, no shadows"])}
            for name, exr in pictures.items()]


def judged(bench, scene, settings, kinds=tuple(TRUTHS)):
    exr, _ = bench.render(scene, settings, bench.options.size)
    return {kind: bench.errors(exr, bench.truth(scene, kind, bench.options.size)) for kind in kinds}


def setting_errors(bench, scene):
    """Fig. 6, errors."""
    return [judged(bench, scene, sets_of(s)) for s in SETTINGS]


def start_errors(bench, scene):
    """Fig. 8, errors."""
    return {start: {str(n): judged(bench, scene, sets_of((start, levels, n)), ON_SCREEN[:1]) for n in SAMPLES}
            for start, levels in STARTS.items()}


def camera_errors(bench, scene):
    """Fig. 9: with the other camera and without, against all light, what the picture shows, and what both show. The camera is
    the scene's first, whose truths are those of the other figures."""
    rows, size = [], bench.options.size
    for camera, other in CAMERAS.get(scene, []):
        view, both = ["--camera", camera], ["--camera", camera, "--source-view", other]
        truths = {"all": bench.truth(scene, "all", size), "screen": bench.truth(scene, "screen", size),
                  "both screens": bench.truth(scene, "screen", size, ["--source-view", other])}
        pictures = {"one": bench.render(scene, [], size, f"{scene}_one", extra=view)[0],
                    "two": bench.render(scene, ["cameras=on"], size, f"{scene}_two", extra=both)[0]}
        name = f"screen_space_cameras_{scene}_{other}.png"
        screen_space_page.draw_cameras([*pictures.values(), truths["both screens"], truths["all"]], ROOT / "docs/images" / name)
        rows.append({"camera": camera, "other": other, "picture": name, "mean": {k: screen_space_page.mean(t) for k, t in truths.items()},
                     "errors": {p: {t: bench.errors(exr, truth) for t, truth in truths.items()} for p, exr in pictures.items()}})
    return rows


def times(bench):
    """Figs. 6, 7 and 8: medians of 5 frames, of three rounds over all settings the quickest: what else the machine does comes and goes."""
    settings = {tuple(s[:3]) for s in SETTINGS} | {(start, levels, n) for start, levels in STARTS.items() for n in SAMPLES if
                                                   start != "full" or n <= 64}
    before = os.getloadavg()[0]
    best = {}
    for setting in 3 * sorted(settings):
        _, report = bench.render(TIMED_SCENE, sets_of(setting), TIMED_SIZE, frames=5, warmup=2)
        if setting not in best or report["total_ms"] < best[setting]["total"]:
            best[setting] = {"setting": list(setting), "total": report["total_ms"],
                             "passes": {p["name"]: p["ms"] for p in report["passes"]}}
    measured = list(best.values())
    device = f"{report['device']}, {report['platform']} {report['driver']}, {report['width']} lanes"
    return {"measured": measured, "device": device, "scene": TIMED_SCENE, "size": TIMED_SIZE,
            "load": [before, os.getloadavg()[0]]}


if __name__ == "__main__":
    main()
