"""What the paper says of its method's weaknesses and of its rival's: a beam that wanders over studs of two colours, and one that meets a block.
Used by static_vpl.py."""
import numpy

import exr_planes
from program import ROOT
from static_vpl_bench import beam_area, read_vpls, with_light

POSITIONS = 17
REACH = 1.2            # m: from the seam between the colours, to both sides
FARTHEST = 4.0         # m: where the wall of studs is
WAYS = {"static": ("static_vpl", True, []), "phantom": ("static_vpl", True, ["variant=phantom"]),
        "traced 1": ("instant_radiosity", False, ["vpls=1"]), "traced 20": ("instant_radiosity", False, ["vpls=20"])}


def studs_scene():
    """A grey room whose far wall is red and green, with studs on it; the camera looks the other way."""
    def wall(name, corners, material="grey"):
        return {"name": name, "quad": corners, "material": material}
    w, h, d = 2.0, 2.6, FARTHEST
    meshes = [wall("floor", [[-w, 0, 0], [w, 0, 0], [w, 0, d], [-w, 0, d]]), wall("ceiling", [[-w, h, 0], [w, h, 0], [w, h, d], [-w, h, d]]),
              wall("near", [[-w, 0, 0], [w, 0, 0], [w, h, 0], [-w, h, 0]]), wall("left", [[-w, 0, 0], [-w, h, 0], [-w, h, d], [-w, 0, d]]),
              wall("right", [[w, 0, 0], [w, h, 0], [w, h, d], [w, 0, d]]),
              wall("red", [[-w, 0, d], [0, 0, d], [0, h, d], [-w, h, d]], "red"), wall("green", [[0, 0, d], [w, 0, d], [w, h, d], [0, h, d]], "green")]
    for i in range(16):
        x = -w + 0.125 + 0.25 * i
        for y in numpy.arange(0.175, h, 0.25):
            meshes.append({"name": "stud", "sphere": {"center": [x, round(float(y), 4), d], "radius": 0.1, "rings": 12}, "material": "red" if x < 0 else "green"})
    torch = {"name": "torch", "kind": "spot", "position": [0, 1.3, 0.5], "intensity": 60, "inner_cone_degrees": 9, "outer_cone_degrees": 13}
    keys = [{"time": t, "target": [x, 1.2, d]} for t, x in ((0, -REACH), (1, REACH))]
    return {"materials": {"grey": {"albedo": 0.6}, "red": {"albedo": [0.7, 0.1, 0.08]}, "green": {"albedo": [0.12, 0.5, 0.1]}}, "meshes": meshes, "sky": 0,
            "cameras": [{"name": "back", "position": [0, 1.5, 2.6], "target": [0, 1.0, 0], "vertical_fov_degrees": 75}],
            "lights": [{**torch, "target": keys[0]["target"], "keys": keys}]}


def studs(bench):
    """By way, over the beam's place: the share of red in the light on the near wall, that light, and how far the VPLs' mean normal is off the wall's."""
    found = bench.kept("studs")
    if found:
        return found
    scene = bench.write("studs_scene", studs_scene())
    bench.place(scene, "studs_vpls", "--cap", 200, "--light-paths", 0)
    file = bench.work / "static_vpl_studs_vpls.json"
    area = beam_area(bench, scene, "studs_area", file)
    found = {way: {"red": [], "light": [], "degrees": []} for way in (*WAYS, "truth")}
    for step in range(POSITIONS):
        moment = ["--time", step / (POSITIONS - 1)]
        for way, (technique, takes, settings) in WAYS.items():
            all_settings = settings + ([f"vpls_file={file}"] if takes else []) + ([f"unit_area={area:.4g}"] if way == "phantom" else [])
            name = f"studs_{way}_{step}".replace(" ", "_")
            exr, _, path = bench.render(scene, name, technique, all_settings, "96x54", moment)
            add(found[way], exr)
            vpls = read_vpls(path)
            axis = (vpls[:, 3:6] * vpls[:, 6:9].sum(axis=1)[:, None]).sum(axis=0)
            found[way]["degrees"].append(float(numpy.degrees(numpy.arccos(-axis[2] / numpy.linalg.norm(axis)))))
        add(found["truth"], bench.truth(scene, f"studs_truth_{step}", 1, bench.options.spp, "96x54", moment))
    return bench.keep("studs", found)


def add(row, exr):
    light = exr_planes.read_planes(exr)
    light = light[light.sum(axis=-1) > 0].mean(axis=0)
    row["red"].append(float(light[0] / light[:2].sum()))
    row["light"].append(float(light.mean()))


def block_scene(bench):
    """Cornell's box, a torch on its tall block: more than the block is wide, so that the wall behind gets some."""
    import json
    scene = json.loads((ROOT / "samples/scenes/cornell.json").read_text(encoding="utf-8"))
    scene["cameras"] = [{"name": "view", "position": [0.278, 0.33, -0.75], "target": [0.278, 0.27, 0.28], "vertical_fov_degrees": 38}]
    scene["lights"] = [{"name": "torch", "kind": "spot", "position": [0.2, 0.4, -0.3], "target": [0.344, 0.24, 0.272], "intensity": 8,
                        "inner_cone_degrees": 17, "outer_cone_degrees": 22}]
    return bench.write("block_scene", scene)


def block(bench):
    """Light of the first bounce, and of two, over the truth of two bounces: behind the phantom's plane and before it."""
    scene = block_scene(bench)
    bench.place(scene, "block_vpls", "--cap", 200, "--light-paths", 0)
    file = bench.work / "static_vpl_block_vpls.json"
    phantom, second = ["variant=phantom", f"unit_area={beam_area(bench, scene, 'block_area', file):.4g}"], ["bounces=2", "average_reflectance=0.6"]
    ways = {"phantom": phantom, "phantom, second bounce": phantom + second, "static": [], "static, second bounce": second}
    exrs = {way: bench.render(scene, f"block_{way}".replace(" ", "_").replace(",", ""), "static_vpl", [*s, f"vpls_file={file}"])[0] for way, s in ways.items()}
    exrs = {"truth": bench.truth(scene, "block_truth", 2, bench.options.spp), **exrs}
    found = bench.kept("block")
    if not found:
        place = read_vpls(bench.work / "static_vpl_block_phantom.txt")[0]
        at = positions(bench, scene, file)
        behind = ((at - place[:3]) @ place[3:6]) < -1e-3
        lit = exr_planes.read_planes(exrs["truth"], ("albedo.G",))[..., 0] > 0
        truth = exr_planes.read_planes(exrs["truth"]).mean(axis=-1)
        for way, exr in exrs.items():
            light = exr_planes.read_planes(exr).mean(axis=-1)
            found[way] = {"behind": float(light[lit & behind].mean() / truth[lit & behind].mean()),
                          "before": float(light[lit & ~behind].mean() / truth[lit & ~behind].mean()),
                          "flip": bench.compare(with_light(exr, exr_planes.read_planes(exr), bench.work / "static_vpl_block_judged.exr"), exrs["truth"])["flip"]}
        bench.keep("block", found)
    return found, exrs


def positions(bench, scene, file):
    """Of each pixel, from the camera's ray and the G-buffer as the technique holds it."""
    path = bench.work / "static_vpl_block_position.exr"
    if not path.exists():
        bench.call("render", scene, "--technique", "rsm", "--set", "interleave=1", "--size", bench.options.size, "--warmup", 0, "--frames", 1,
                   "--debug-view", f"position={path}", "--json")
    return exr_planes.read_planes(path, ("c00", "c01", "c02"))
