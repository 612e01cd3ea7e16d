"""Two scenes in which a spot sweeps and a crate moves: FLIP of static VPLs, of a phantom, and of instant radiosity. Used by static_vpl.py."""
import json

import numpy

import exr_planes
from program import ROOT
from static_vpl_bench import beam_area, read_vpls, spheres, with_light

FRAMES = 4
# VPLs, and what makes them. `places` is the cap of place-vpls; a phantom takes its looks from 200.
VARIANTS = {"phantom": (1, "static_vpl", 200, ["variant=phantom"]), "traced 1": (1, "instant_radiosity", 0, ["vpls=1"]),
            "static 20": (20, "static_vpl", 20, []), "traced 20": (20, "instant_radiosity", 0, ["vpls=20"]),
            "static 200": (200, "static_vpl", 200, []), "traced 200": (200, "instant_radiosity", 0, ["vpls=200"]),
            "traced 200, shadows": (200, "instant_radiosity", 0, ["vpls=200", "shadows=on"])}
CRATE = {"material": "crate", "object": "crate", "name": "crate"}
COLOUR = {"albedo": [0.15, 0.25, 0.6]}
REFLECTANCE = {"rooms": 0.65, "sponza": 0.4}  # what the second bounce takes for the surfaces' mean


def rooms_scene(bench):
    """The lit room of the shipped `rooms`, its door shut; the lamp's beam wanders from the wall over the door to the corner."""
    scene = json.loads((ROOT / "samples/scenes/rooms.json").read_text(encoding="utf-8"))
    scene["objects"] = [{"name": "door", "keys": [{"time": 0, "translate": [-0.099, 0, -0.5]}]},
                        {"name": "crate", "keys": [{"time": 0, "translate": [0, 0, -1.4]}, {"time": 1, "translate": [0, 0, 1.0]}]}]
    scene["materials"]["crate"] = COLOUR
    scene["meshes"].append({**CRATE, "box": {"lower": [-1.5, 0.002, -0.3], "upper": [-0.9, 0.9, 0.3]}})
    scene["cameras"] = [c for c in scene["cameras"] if c["name"] == "lit_room"]
    lamp = {"name": "lamp", "kind": "spot", "position": [-3.2, 2.3, 0.3], "intensity": 60, "inner_cone_degrees": 20, "outer_cone_degrees": 26}
    scene["lights"] = [{**lamp, "target": [-0.6, 0.3, -1.9], "keys": [{"time": 0, "target": [-0.6, 0.3, -1.9]}, {"time": 1, "target": [-0.6, 0.3, 1.9]}]}]
    return bench.write("rooms_scene", scene)


def sponza_scene(bench):
    """A torch among the curtains of Crytek's Sponza."""
    torch = {"name": "torch", "kind": "spot", "position": [-6, 2, 0], "intensity": 400, "inner_cone_degrees": 18, "outer_cone_degrees": 24}
    scene = {"meshes": [{"file": bench.path_of("sponza_crytek")}, {**CRATE, "box": {"lower": [-2.8, 0.01, -0.6], "upper": [-1.6, 1.2, 0.6]}}],
             "materials": {"crate": COLOUR}, "objects": [{"name": "crate", "keys": [{"time": 0, "translate": [0, 0, -1.8]}, {"time": 1, "translate": [0, 0, 1.8]}]}],
             "cameras": [{"name": "view", "position": [-9.5, 2.2, -0.3], "target": [5, 3, 0], "vertical_fov_degrees": 55}],
             "lights": [{**torch, "target": [0, 2.2, -4.5], "keys": [{"time": 0, "target": [0, 2.2, -4.5]}, {"time": 1, "target": [0, 2.2, 4.5]}]}]}
    return bench.write("sponza_scene", scene)


SCENES = {"rooms": rooms_scene, "sponza": sponza_scene}


def files_of(bench, name, scene):
    """Of 20 and of 200 places: placed at half-way, before light falls anywhere; the crate has a sphere that dims what passes it."""
    files = {}
    for cap in (20, 200):
        vpls = bench.place(scene, f"{name}_places{cap}", "--cap", cap, "--light-paths", 0, "--time", 0.5)
        middle = [-1.2, 0.45, 0] if name == "rooms" else [-2.2, 0.6, 0]
        vpls["blockers"] = spheres([middle], 0.6, object="crate")
        files[cap] = bench.write(f"{name}_vpls{cap}", vpls)
    return files


def pictures(bench, name, frame):
    """Of one frame: by variant the light of one bounce and of two, and how many VPLs make it; the truths of both."""
    scene = SCENES[name](bench)
    files, moment = files_of(bench, name, scene), ["--time", frame / (FRAMES - 1)]
    area = beam_area(bench, scene, f"{name}_area", files[200], ["--time", 0.5])
    made = {}

    def light(variant, technique, cap, settings):
        own = [f"vpls_file={files[cap]}"] if cap else []
        if variant.startswith("phantom"):
            own.append(f"unit_area={area:.4g}")
        key = f"{name}_{variant}_{frame}".replace(" ", "_").replace(",", "")
        exr, report, vpls = bench.render(scene, key, technique, settings + own, extra=moment)
        return exr, exr_planes.read_planes(exr), report["counts"], read_vpls(vpls)[:, 6:9].sum()

    second = ["bounces=2", f"average_reflectance={REFLECTANCE[name]}"]
    for variant, (_, technique, cap, settings) in VARIANTS.items():
        exr, one, counts, flux = light(variant, technique, cap, settings)
        kept = counts["kept_vpls"] + counts["phantom_vpls"] if "kept_vpls" in counts else counts["vpls"]
        made[variant] = {"exr": exr, "one": one, "vpls": kept, "flux": flux}
        if technique == "static_vpl":
            made[variant]["two"] = light(f"{variant} second", technique, cap, settings + second)[1]
    # As the paper has it, traced VPLs get a second bounce like that of places, of their own flux.
    places = made["static 200"]
    more = (places["two"] - places["one"]) / places["flux"]
    for picture in made.values():
        picture.setdefault("two", picture["one"] + picture["flux"] * more)
    return made, truths(bench, name, scene, frame, moment)


def truths(bench, name, scene, frame, moment):
    exr = bench.truth(scene, f"{name}_truth_{frame}", 2, bench.options.spp, extra=moment)
    layers = {"one": [f"bounce1.{c}" for c in "RGB"], "two": list("RGB")}
    return {bounces: with_light(exr, exr_planes.read_planes(exr, names), bench.work / f"static_vpl_{name}_truth_{frame}_{bounces}.exr")
            for bounces, names in layers.items()}


def flip(bench):
    """By scene, variant and bounces: FLIP, relMSE and bias of each frame, and the VPLs' number; and the pictures of one frame, of one bounce."""
    found = bench.kept("flip")
    for name in SCENES:
        if name in found:
            continue
        rows = {}
        for frame in range(FRAMES):
            made, truth = pictures(bench, name, frame)
            for variant, picture in made.items():
                row = rows.setdefault(variant, {"vpls": [], "one": [], "two": []})
                row["vpls"].append(picture["vpls"])
                for bounces in ("one", "two"):
                    image = picture["exr"]  # of one bounce
                    if bounces == "two":
                        image = with_light(image, picture["two"], bench.work / f"static_vpl_flip_judged_{name}.exr")
                    errors = bench.compare(image, truth[bounces])
                    row[bounces].append({key: errors[key] for key in ("flip", "relMSE", "bias")})
        found[name] = rows
        bench.keep("flip", found)
    names = {"truth": "truth_1_one", "static 200": "static_200_1", "phantom": "phantom_1", "traced 20": "traced_20_1"}
    return found, {scene: {way: bench.work / f"static_vpl_{scene}_{name}.exr" for way, name in names.items()} for scene in SCENES}


def mean(values, key):
    return float(numpy.mean([v[key] for v in values]))
