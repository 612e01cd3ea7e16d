#!/usr/bin/env python3
"""Writes the shipped scenes beside this script (format: docs/scenes.md).

Python 3, standard library only; the same output on every run. `--check` compares instead of writing.
"""
import json
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent

# RGB reflectances of the Cornell box as used with its "original" variant.
WHITE, RED, GREEN = [0.725, 0.71, 0.68], [0.63, 0.065, 0.05], [0.14, 0.45, 0.091]


def quad(name, corners, material, **more):
    return {"name": name, "quad": corners, "material": material, **more}


def box(name, lower, upper, material, **more):
    return {"name": name, "box": {"lower": lower, "upper": upper}, "material": material, **more}


def sphere(name, center, radius, material, rings=32):
    return {"name": name, "sphere": {"center": center, "radius": radius, "rings": rings}, "material": material}


def camera(name, position, target, degrees, aspect=None, **more):
    result = {"name": name, "position": position, "target": target, "vertical_fov_degrees": degrees}
    if aspect is not None:
        result["aspect"] = aspect
    return {**result, **more}


def cornell():
    """Cornell University's measurements of the box (in mm there; metres here), without the lamp's quad."""
    def metres(points):
        return [[c / 1000.0 for c in p] for p in points]

    def block(name, top):
        floor = [[x, 0.0, z] for x, _, z in top]
        meshes = [quad(name + "_top", metres(top), "white")]
        for i in range(4):
            j = (i + 1) % 4
            meshes.append(quad(f"{name}_side_{i}", metres([top[i], floor[i], floor[j], top[j]]), "white"))
        return meshes

    h, d = 548.8, 559.2
    walls = [
        quad("floor", metres([[552.8, 0, 0], [0, 0, 0], [0, 0, d], [549.6, 0, d]]), "white"),
        quad("ceiling", metres([[556, h, 0], [556, h, d], [0, h, d], [0, h, 0]]), "white"),
        quad("back", metres([[549.6, 0, d], [0, 0, d], [0, h, d], [556, h, d]]), "white"),
        quad("right", metres([[0, 0, d], [0, 0, 0], [0, h, 0], [0, h, d]]), "green"),
        quad("left", metres([[552.8, 0, 0], [549.6, 0, d], [556, h, d], [556, h, 0]]), "red"),
    ]
    short = [[130, 165, 65], [82, 165, 225], [240, 165, 272], [290, 165, 114]]
    tall = [[423, 330, 247], [265, 330, 296], [314, 330, 456], [472, 330, 406]]
    return {
        "description": "Cornell box from its published measurements, lit by a spot under the ceiling",
        "materials": {"white": {"albedo": WHITE}, "red": {"albedo": RED}, "green": {"albedo": GREEN}},
        "meshes": walls + block("short", short) + block("tall", tall),
        "cameras": [
            # The measured camera: focal length 35 mm, film 25 mm square.
            camera("front", [0.278, 0.273, -0.8], [0.278, 0.273, 0.0],
                   math.degrees(2 * math.atan(12.5 / 35)), 1.0),
            camera("inside", [0.45, 0.42, 0.03], [0.16, 0.14, 0.4], 65.0),
        ],
        "lights": [{"name": "lamp", "kind": "spot", "position": [0.278, 0.54, 0.2795],
                    "direction": [0, -1, 0], "intensity": 8.0,
                    "inner_cone_degrees": 54.0, "outer_cone_degrees": 60.0}],
    }


def basic():
    """The thesis's basic scene: a crate and a red sphere on a yellow floor, one sun."""
    return {
        "description": "Cube and red sphere on a yellow floor; colour bleeds onto the cube's dark side",
        "materials": {"floor": {"albedo": [0.72, 0.6, 0.18]}, "cube": {"albedo": [0.7, 0.7, 0.7]},
                      "sphere": {"albedo": [0.75, 0.08, 0.06]}},
        "meshes": [
            quad("floor", [[-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]], "floor"),
            box("cube", [-1.2, 0.0, -0.5], [-0.2, 1.0, 0.5], "cube"),
            sphere("sphere", [0.75, 0.5, 0.05], 0.5, "sphere"),
        ],
        "cameras": [
            camera("overview", [1.2, 2.2, 4.6], [-0.1, 0.35, 0.0], 40.0),
            camera("bleeding", [1.0, 1.5, 2.2], [-0.15, 0.45, 0.1], 38.0),
        ],
        "lights": [{"name": "sun", "kind": "sun", "direction": [0.4, -1.0, -0.55], "irradiance": 10.0}],
    }


def rooms():
    """Two rooms; the lamp is in the first. The door between them is open at 0 s and 8 s, shut at 4 s."""
    wall, height, depth, length = 0.2, 2.6, 2.0, 4.0
    far, half = length + wall / 2, wall / 2
    out = wall  # the outer walls' thickness

    def room(name, sign, side):
        x = sorted([sign * half, sign * far])
        end = sorted([sign * far, sign * (far + out)])
        return [
            box(name + "_floor", [x[0] - half, -out, -depth - out], [x[1] + half, 0, depth + out], name + "_floor"),
            box(name + "_ceiling", [x[0] - half, height, -depth - out], [x[1] + half, height + out, depth + out], "white"),
            box(name + "_back", [x[0] - half, 0, -depth - out], [x[1] + half, height, -depth], "white"),
            box(name + "_front", [x[0] - half, 0, depth], [x[1] + half, height, depth + out], side),
            box(name + "_end", [end[0], -out, -depth - out], [end[1], height + out, depth + out], "white"),
        ]

    door_width, door_height, lap = 0.9, 2.0, 0.05
    z = door_width / 2
    # The closed leaf laps over the opening on the first room's side and reaches 1 mm into wall and
    # floor, so that nothing but the door decides whether the second room is dark.
    hinge = [-half + 0.001, 0.0, -z - lap]
    return {
        "description": "Two rooms, the lamp in the first; the door between them is open at 0 s and 8 s, shut at 4 s",
        "materials": {"white": {"albedo": [0.75, 0.74, 0.7]}, "green": {"albedo": [0.2, 0.5, 0.25]},
                      "lit_floor": {"albedo": [0.55, 0.35, 0.2]}, "dark_floor": {"albedo": [0.45, 0.45, 0.5]},
                      "door": {"albedo": [0.5, 0.12, 0.08]}},
        "objects": [{"name": "door", "keys": [
            {"time": 0.0, "translate": hinge, "rotate": {"axis": [0, 1, 0], "degrees": -100.0}},
            {"time": 4.0, "translate": hinge},
            {"time": 8.0, "translate": hinge, "rotate": {"axis": [0, 1, 0], "degrees": -100.0}}]}],
        "meshes": room("lit", -1, "white") + room("dark", 1, "green") + [
            box("partition_left", [-half, 0, -depth], [half, height, -z], "white"),
            box("partition_right", [-half, 0, z], [half, height, depth], "white"),
            box("lintel", [-half, door_height, -z], [half, height, z], "white"),
            box("leaf", [-0.04, -0.001, 0.0], [0.0, door_height + lap, door_width + 2 * lap], "door", object="door"),
        ],
        "cameras": [
            camera("dark_room", [3.7, 1.6, -1.6], [0.0, 1.0, 0.3], 62.0),
            camera("lit_room", [-3.8, 1.7, 1.7], [0.0, 0.9, -0.2], 62.0),
            camera("walk", [3.6, 1.6, 0.2], [0.0, 1.2, 0.0], 60.0, keys=[
                {"time": 0.0}, {"time": 4.0, "position": [1.2, 1.6, 0.2], "target": [-2.4, 1.0, 0.0]}]),
        ],
        "lights": [{"name": "lamp", "kind": "spot", "position": [-3.2, 2.3, 0.3], "target": [0.7, 0.0, 0.0],
                    "intensity": 60.0, "inner_cone_degrees": 20.0, "outer_cone_degrees": 24.0}],
    }


def furnace():
    """Closed box, albedo 1/2, radiance 1 / pi from every wall: exitance 1, in all 2, bounce k 2^-k."""
    return {
        "description": "Closed box of albedo 0.5 whose walls all emit an exitance of 1 W/m^2",
        "materials": {"wall": {"albedo": 0.5, "emission": 1.0 / math.pi}},
        "meshes": [box("walls", [-1, -1, -1], [1, 1, 1], "wall")],
        "cameras": [camera("inside", [0.6, 0.5, 0.7], [-0.5, -0.3, -1.0], 70.0)],
        "lights": [],
        "emissive_surfaces": True,
    }


def sphere_room():
    """Unit sphere, albedo 1/2, intensity pi at its centre: E = pi directly, pi / 2^k from bounce k."""
    return {
        "description": "Inside of a sphere of radius 1 and albedo 0.5 with a point light of intensity pi in the middle",
        "materials": {"wall": {"albedo": 0.5}},
        "meshes": [sphere("walls", [0, 0, 0], 1.0, "wall", 64)],
        "cameras": [camera("inside", [0.3, 0.2, 0.6], [-0.4, -0.2, -1.0], 70.0)],
        "lights": [{"name": "centre", "kind": "point", "position": [0, 0, 0], "intensity": math.pi}],
    }


def rounded(value):
    """Floats to 8 decimals, so that sums read as they are meant."""
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return round(value, 8) if isinstance(value, float) else value


def text(value, indent=""):
    """JSON with one line per list of numbers or short object."""
    flat = json.dumps(value)
    if not isinstance(value, (dict, list)) or len(flat) + len(indent) <= 100:
        return flat
    inner = indent + "  "
    if isinstance(value, dict):
        items = [f"{inner}{json.dumps(k)}: {text(v, inner)}" for k, v in value.items()]
        return "{\n" + ",\n".join(items) + "\n" + indent + "}"
    return "[\n" + ",\n".join(inner + text(v, inner) for v in value) + "\n" + indent + "]"


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(f"make_scenes.py: unknown argument {sys.argv[1]!r}; expected nothing or --check")
    for make in (cornell, basic, rooms, furnace, sphere_room):
        path = HERE / (make.__name__ + ".json")
        content = text(rounded(make())) + "\n"
        if not check:
            path.write_text(content)
        elif not path.is_file() or path.read_text() != content:
            sys.exit(f"{path} differs from what make_scenes.py makes; run it")


if __name__ == "__main__":
    main()
