"""A room behind a door that opens, and a lorry that drives past things: soft spheres against what rays say. Used by static_vpl.py."""
import numpy

import exr_planes
from static_vpl_bench import green, lattice, read_vpls, spheres

ANGLES = [0, 5, 10, 15, 20, 30, 40, 50, 60, 70, 80, 90]
OPEN = 100             # degrees, at 1 s
HALF, HEIGHT, DEPTH = 2.0, 2.6, 4.0  # m: the room
DOORWAY = (0.5, 2.0)   # m: half its width, its height
WAY = [-14.0, 14.0]    # m: the lorry's
STEPS = 41
SIDE = (3.0, 1.6)      # m: of the lorry that the sun shines on


def box(name, lower, upper, **more):
    return {"name": name, "box": {"lower": lower, "upper": upper}, "material": "grey", **more}


def door_scene():
    """The sun comes along +z through the doorway. Nothing outside could send light back but the door itself."""
    half, top = DOORWAY
    wide, out = HALF + 0.1, DEPTH + 0.1
    meshes = [box("floor", [-wide, -0.1, -0.1], [wide, 0, out]), box("ceiling", [-wide, HEIGHT, -0.1], [wide, HEIGHT + 0.1, out]),
              box("back", [-wide, 0, DEPTH], [wide, HEIGHT, out]), box("left", [-wide, 0, 0], [-HALF, HEIGHT, DEPTH]),
              box("right", [HALF, 0, 0], [wide, HEIGHT, DEPTH]), box("front left", [-wide, 0, -0.1], [-half, HEIGHT, 0]),
              box("front right", [half, 0, -0.1], [wide, HEIGHT, 0]), box("lintel", [-half, top, -0.1], [half, HEIGHT, 0]),
              box("leaf", [0, 0, -0.03], [2 * half + 0.04, top + 0.02, 0], object="door")]
    keys = [{"time": t, "translate": [-half - 0.02, 0, -0.1], "rotate": {"axis": [0, 1, 0], "degrees": a}} for t, a in ((0, 0), (1, OPEN))]
    return {"materials": {"grey": {"albedo": 0.6}}, "meshes": meshes, "objects": [{"name": "door", "keys": keys}], "sky": 0,
            "cameras": [{"name": "inside", "position": [1.7, 1.5, 0.3], "target": [-0.5, 0.8, 3.5], "vertical_fov_degrees": 75}],
            "lights": [{"name": "sun", "kind": "sun", "direction": [0, -0.45, 1], "irradiance": 10}]}


def door_blockers():
    """A path through wall or door must meet a dozen spheres: they lie half their radius apart."""
    half, top = DOORWAY
    wall = [p for p in lattice([-2.1, 0, -0.05], [2.1, HEIGHT, -0.05], 0.15) if abs(p[0]) > half + 0.24 or p[1] > top + 0.24]
    roof = lattice([-2.1, HEIGHT + 0.15, 0], [2.1, HEIGHT + 0.15, DEPTH], 0.3)
    leaf = lattice([0.02, 0, -0.015], [2 * half, top + 0.1, -0.015], 0.15)
    return spheres(wall, 0.3) + spheres(roof, 0.6) + spheres(leaf, 0.3, object="door")


def door(bench):
    """By angle: what the places send, how many are kept, and the light in a picture; ours and the truth."""
    found = bench.kept("door")
    if found:
        return found
    scene = bench.write("door_scene", door_scene())
    placing = ["--from", f"0,1.3,{DEPTH / 2}", "--light-paths", 0, "--cap", 200]
    vpls = bench.place(scene, "door_places", *placing, "--time", 1)
    vpls["blockers"] = door_blockers()
    file = bench.write("door_vpls", vpls)
    for angle in ANGLES:
        moment = ["--time", angle / OPEN]
        every = [f"vpls_file={file}", "cull_relative=0"]
        ours, _, vpls = bench.render(scene, f"door_ours_{angle}", "static_vpl", every, "160x90", moment)
        sent = read_vpls(vpls)[:, 7].sum()
        _, report, _ = bench.render(scene, f"door_kept_{angle}", "static_vpl", [f"vpls_file={file}"], "160x90", moment)
        truth = bench.truth(scene, f"door_truth_{angle}", 1, 4 * bench.options.spp, "160x90", moment)
        traced = read_vpls(bench.render(scene, f"door_traced_{angle}", "instant_radiosity", ["vpls=262144"], "32x18", moment)[2])
        at = traced[:, :3]
        inside = traced[((at > [-HALF - 1e-3, -1e-3, -1e-3]) & (at < [HALF + 1e-3, HEIGHT + 1e-3, DEPTH + 1e-3])).all(axis=1)]
        found[angle] = {"sent": sent, "traced": inside[:, 7].sum(), "kept": report["counts"]["kept_vpls"], "ours": green(ours).mean(),
                        "truth": green(truth).mean()}
    return bench.keep("door", {str(a): f for a, f in found.items()})


def road_scene():
    """A lorry on a road, seen from between it and the things that the sun, from +z, shines past."""
    wide, high = SIDE
    meshes = [box("ground", [-30, -0.2, -10], [30, 0, 10]), box("lorry", [-wide / 2, 0.2, -0.6], [wide / 2, 0.2 + high, 0.6], object="lorry"),
              box("tower", [-9, 0, 3], [-6, 7, 4.5]), {"name": "tree", "sphere": {"center": [-1, 3, 2.8], "radius": 1.2}, "material": "grey"},
              box("trunk", [-1.1, 0, 2.7], [-0.9, 2, 2.9]), box("pillar", [3.8, 0, 3], [4.2, 6, 3.4]), box("pillar", [5.6, 0, 3], [6, 6, 3.4]),
              box("wall", [8.5, 0, 3], [12, 2.4, 3.2])]
    camera = {"name": "beside", "position": [0, 0.2 + high / 2, 2], "target": [0, 0.2 + high / 2, 0.6], "vertical_fov_degrees": 59.49}
    places = [{"time": t, "position": [x, *camera["position"][1:]], "target": [x, *camera["target"][1:]]} for t, x in enumerate(WAY)]
    moves = [{"time": t, "translate": [x, 0, 0]} for t, x in enumerate(WAY)]
    return {"materials": {"grey": {"albedo": 0.5}}, "meshes": meshes, "objects": [{"name": "lorry", "keys": moves}], "sky": 0,
            "cameras": [{**camera, "keys": places}], "lights": [{"name": "sun", "kind": "sun", "direction": [0, -0.6, -1], "irradiance": 10}]}


def road_vpls():
    """What an author would set: a place on the lorry's side, and a few spheres for each thing."""
    side = {"name": "lorry's side", "object": "lorry", "position": [0, 0.2 + SIDE[1] / 2, 0.6], "normal": [0, 0, 1], "reflectance": 0.5,
            "weight": SIDE[0] * SIDE[1]}
    blockers = (spheres(lattice([-8.3, 1, 3.7], [-6.7, 5, 3.7], 0.8), 1.0) + spheres([[-1, 3, 2.8]], 1.5) +
                spheres(lattice([4, 1, 3.2], [4, 5, 3.2], 0.4), 0.45) + spheres(lattice([5.8, 1, 3.2], [5.8, 5, 3.2], 0.4), 0.45) +
                spheres(lattice([9.2, 1.5, 3.1], [11.3, 1.5, 3.1], 0.7), 1.1))
    return {"format": "lightwell-static-vpls", "version": 1, "vpls": [side], "blockers": blockers}


def road(bench):
    """Along the way: the spheres' share of light, and what rays say at the place and over the side that it stands for."""
    found = bench.kept("road")
    if found:
        return found
    scene = bench.write("road_scene", road_scene())
    file = bench.write("road_vpls", road_vpls())
    full = 10 / numpy.hypot(1, 0.6)  # W/m^2 on the lorry's side
    rows = {"x": [], "ours": [], "place": [], "side": []}
    for step in range(STEPS):
        time = step / (STEPS - 1)
        settings = [f"vpls_file={file}", "cull_relative=0"]
        sent = read_vpls(bench.render(scene, f"road_ours_{step}", "static_vpl", settings, "32x18", ["--time", time])[2])[:, 7].sum()
        exr, _, _ = bench.render(scene, f"road_side_{step}", "none", (), "60x32", ["--time", time])
        planes = exr_planes.read_planes(exr, ("direct.G", "albedo.G"))
        lit = numpy.pi * planes[..., 0] / planes[..., 1] / full
        rows["x"].append(WAY[0] + time * (WAY[1] - WAY[0]))
        rows["ours"].append(sent / (0.5 * SIDE[0] * SIDE[1] * full))
        rows["place"].append(float(lit[15:17, 29:31].mean()))
        rows["side"].append(float(lit.mean()))
    return bench.keep("road", rows)
