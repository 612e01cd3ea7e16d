"""Scenes, views and truths of ten Brug 2017, and a technique's pictures of them. Used by lpv_thesis.py and cone_tracing_thesis.py."""
import functools
import json

import exr_planes
from program import caller

SCENES = {"basic": {"title": "Basic scene", "views": ["overview", "bleeding"], "size": "1280x720"},
          "sponza": {"title": "Sponza", "views": ["overview", "cloth"], "size": "640x480"}}
COLOURS = ("R", "G", "B")
SHADING = [f"{layer}.{c}" for layer in ("direct", "albedo", "normal") for c in COLOURS]
# The hemisphere of the source's SSAO, evenly covered and packed towards its centre; its radius is not published.
SSAO = ["method=ssao", "weighting=uniform", "resolution=full"]
SPONZA = {"cameras": [{"name": "overview", "position": [-9.5, 2.2, -0.3], "target": [5, 3, 0], "vertical_fov_degrees": 55},
                      {"name": "cloth", "position": [-6.0, 2.0, 0.8], "target": [-2.0, 1.9, 3.2], "vertical_fov_degrees": 45}],
          "lights": [{"name": "sun", "kind": "sun", "direction": [0.15, -1, 0.33], "irradiance": 10}]}


class Setting:
    """Pictures of one view, and what they are worth against its truth."""

    def __init__(self, options, call, scene, view):
        self.options, self.call, self.scene, self.view = options, call, scene, view
        self.file = scene_file(options, call, scene)

    @functools.cached_property
    def truth(self):
        out = self.path("truth")
        if not out.exists():
            self.lightwell("reference", "--bounces", "all", "--spp", self.options.spp, "--half", "--out", out)
        return out

    def path(self, name):
        return self.options.work / f"thesis_{self.scene}_{self.view}_{name}.exr"

    def lightwell(self, command, *arguments):
        return self.call(command, self.file, "--camera", self.view, "--size", SCENES[self.scene]["size"], *arguments)

    def own(self, settings):
        return [s if isinstance(s, str) else s[self.scene] for s in settings]

    def picture(self, technique, settings, *more):
        return self.path("_".join([technique, *self.own(settings), *more]).replace("=", "").replace("--quantity_", ""))

    def is_measured(self, technique, settings, occluded):
        picture = self.picture(technique, settings)
        return picture.with_name(picture.stem + "_ssao.json" if occluded else picture.stem + ".json").exists()

    def render(self, technique, settings, *more):
        """settings: "name=value", or by scene."""
        settings = self.own(settings)
        out = self.picture(technique, settings, *more)
        if not out.exists():
            self.lightwell("render", "--technique", technique, "--warmup", 0, "--frames", 1,
                           *(part for s in settings for part in ("--set", s)), *more, "--out", out)
        return out

    def row(self, technique, settings, occluded):
        """The picture of a row: the technique's, its indirect light times ambient occlusion where the row has it."""
        picture = self.render(technique, settings)
        if not occluded:
            return picture
        out = picture.with_name(picture.stem + "_ssao.exr")
        if not out.exists():
            planes = exr_planes.read_planes(picture, [*COLOURS, *SHADING])
            planes[..., :3] *= exr_planes.read_planes(self.render("ao", SSAO, "--quantity", "ambient-occlusion"), ("R",))
            write(out, planes)
        return out

    def part(self, layer):
        """A layer of the truth as a picture of its own: "bounce1", the first bounce; "a.all" and "b.all", halves of the paths."""
        out = self.path("truth_" + layer)
        if not out.exists():
            write(out, exr_planes.read_planes(self.truth, [*(f"{layer}.{c}" for c in COLOURS), *SHADING]))
        return out

    def figures(self, picture, truth=None):
        kept = picture.with_suffix(".one.json" if truth else ".json")
        if not kept.exists():
            kept.write_text(self.call("compare", picture, truth or self.truth, "--json"))
        return json.loads(kept.read_text())

    def floor(self):
        """Score of one half of the truth's paths against the other: what noise alone costs, twice over."""
        return self.figures(self.part("a.all"), self.part("b.all"))["score"]


def settings_of(options):
    """(settings by scene and view, call)."""
    call = caller(options.lightwell)
    return {(scene, view): Setting(options, call, scene, view) for scene, s in SCENES.items() for view in s["views"]}, call


def write(path, planes):
    exr_planes.write_planes(path, {name: planes[..., i] for i, name in enumerate([*COLOURS, *SHADING])})


def scene_file(options, call, scene):
    if scene != "sponza":
        return scene
    path = options.work / "thesis_sponza.json"
    mesh = next(s["path"] for s in json.loads(call("scenes", "--json")) if s["name"] == "sponza_crytek")
    path.write_text(json.dumps({"meshes": [{"file": mesh}], **SPONZA}))
    return path
