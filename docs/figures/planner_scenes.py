#!/usr/bin/env python3
"""Made-up buildings that the planner's error model learns from, beside the scenes that it is judged by (planner_measure.py): rooms behind windows
and doors, passages beside courts, blinds, blocks under the sun, rooms with a lamp of their own. Written as scene JSON (docs/scenes.md); the same on every run.

What light does in a building is a matter of its openings: how large, how many, how far from the view, and whether a sun or a lamp stands
behind. The real scenes have a handful of each; here they are drawn at random.

    docs/figures/planner_scenes.py [--lightwell PROGRAM]    docs/images/planner_made.jpg: all of them, in a minute
"""
import json
import random

THICK = 0.2  # walls
KINDS = ["window", "door", "passage", "blinds", "blocks"] * 4 + ["lamp"] * 4


def write(folder):
    """A scene file for each of KINDS."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, kind in enumerate(KINDS):
        path = folder / f"made_{number + 1:02}_{kind}.json"
        path.write_text(json.dumps(globals()[kind](random.Random(number + 1)), indent=1), encoding="utf-8")
        paths.append(path)
    return paths


class Building:
    def __init__(self, rng, description):
        self.rng, self.description = rng, description
        self.meshes, self.materials = [], {}

    def material(self, low=0.35, high=0.8, colour=0.3):
        """Grey of the range, some of it coloured."""
        grey = self.rng.uniform(low, high)
        albedo = [round(min(0.9, grey * (1 + self.rng.uniform(-colour, colour))), 3) for _ in range(3)]
        name = f"m{len(self.materials)}"
        self.materials[name] = {"albedo": albedo}
        return name

    def box(self, lower, upper, material):
        if all(b - a > 1e-6 for a, b in zip(lower, upper)):
            self.meshes.append({"box": {"lower": [round(v, 4) for v in lower], "upper": [round(v, 4) for v in upper]}, "material": material})

    def wall(self, axis, at, along, height, holes, material):
        """Across `axis` (0: x, 2: z) at `at`, from along[0] to along[1], up to `height`; holes: (from, to, sill, lintel)."""
        def piece(a, b, low, high):
            lower, upper = [0.0, low, 0.0], [0.0, high, 0.0]
            lower[axis], upper[axis] = at - THICK / 2, at + THICK / 2
            lower[2 - axis], upper[2 - axis] = a, b
            self.box(lower, upper, material)

        here = along[0]
        for a, b, sill, lintel in sorted(holes):
            piece(here, a, 0, height)
            piece(a, b, 0, sill)
            piece(a, b, lintel, height)
            here = b
        piece(here, along[1], 0, height)

    def room(self, x, z, height, holes):
        """Walls, floor and ceiling around x[0]..x[1], z[0]..z[1]; holes by side: "west", "east", "south", "north"; no wall on a side that is
        not named."""
        paint = self.material(0.45, 0.8, 0.15)
        outer = (x[0] - THICK / 2, x[1] + THICK / 2)
        for side, axis, at, along in (("west", 0, x[0], z), ("east", 0, x[1], z), ("south", 2, z[0], outer), ("north", 2, z[1], outer)):
            if side in holes:
                self.wall(axis, at, along, height, holes[side], paint if self.rng.random() < 0.7 else self.material(colour=0.6))
        self.box((x[0], 0, z[0]), (x[1], 0.02, z[1]), self.material(0.2, 0.6, 0.4))
        self.box((outer[0], height, z[0] - THICK / 2), (outer[1], height + THICK, z[1] + THICK / 2), paint)

    def furniture(self, x, z, number, tallest, away=()):
        """Boxes and spheres on the floor, none at the places `away`."""
        for _ in range(number):
            w, d, h = (self.rng.uniform(0.2, 1.2) for _ in range(3))
            cx, cz = self.rng.uniform(x[0] + w, x[1] - w), self.rng.uniform(z[0] + d, z[1] - d)
            if any((cx - p[0]) ** 2 + (cz - p[2]) ** 2 < 1.5 ** 2 for p in away):
                continue
            h = min(h * 1.5, tallest)
            if self.rng.random() < 0.2:
                r = min(w, d, h) / 2
                self.meshes.append({"sphere": {"center": [round(cx, 3), round(r, 3), round(cz, 3)], "radius": round(r, 3)}, "material": self.material(colour=0.6)})
            else:
                self.box((cx - w / 2, 0, cz - d / 2), (cx + w / 2, h, cz + d / 2), self.material(colour=0.6))

    def ground(self):
        """Not far around all boxes: that would only thin out the light's texels."""
        boxes = [mesh["box"] for mesh in self.meshes if "box" in mesh]
        x, z = ((min(b["lower"][axis] for b in boxes) - 5, max(b["upper"][axis] for b in boxes) + 5) for axis in (0, 2))
        self.box((x[0], -1, z[0]), (x[1], 0, z[1]), self.material(0.2, 0.5))

    def scene(self, position, target, light):
        self.ground()
        camera = {"name": "camera", "position": [round(v, 3) for v in position], "target": [round(v, 3) for v in target],
                  "vertical_fov_degrees": round(self.rng.uniform(45, 62), 1)}
        return {"description": self.description, "materials": self.materials, "meshes": self.meshes, "cameras": [camera], "lights": [light]}


def sun(rng, towards):
    """Travels roughly the way `towards` (x, z): a sun of 19 to 67 degrees above the horizon, a higher one where `towards` is short."""
    steep = rng.uniform(0.5, 1.4)
    return {"name": "sun", "kind": "sun", "direction": [round(towards[0] + rng.uniform(-0.4, 0.4), 3), -round(steep, 3), round(towards[1] + rng.uniform(-0.4, 0.4), 3)],
            "irradiance": 10.0}


def windows(rng, along, height, number, share):
    """`number` holes that take `share` of the wall's length together."""
    length, holes = along[1] - along[0], []
    for i in range(number):
        centre = along[0] + length * (i + 0.5 + rng.uniform(-0.15, 0.15)) / number
        half = length * min(share, 0.7) / number / 2  # within its part of the wall, wherever its centre is
        sill = rng.uniform(0.5, 1.1)
        holes.append((centre - half, centre + half, sill, rng.uniform(max(sill + 0.4, 1.5), height - 0.2)))
    return holes


def window(rng):
    """A room with windows to the sun on one side; the camera looks along it or away from them."""
    b = Building(rng, "A room behind windows")
    x, z, height = (0.0, rng.uniform(3.5, 8)), (0.0, rng.uniform(3, 6)), rng.uniform(2.5, 3.6)
    b.room(x, z, height, {"west": windows(rng, z, height, rng.randint(1, 3), rng.uniform(0.12, 0.6)), "east": [], "south": [], "north": []})
    eye = (rng.uniform(0.5, 1.2), rng.uniform(1.2, 1.8), z[0] + rng.uniform(0.4, 1.0))
    b.furniture(x, z, rng.randint(4, 10), 1.4, [eye])
    return b.scene(eye, (x[1], rng.uniform(0.6, 1.4), z[1] - rng.uniform(0, 1.5)), sun(rng, (1, 0)))


def door(rng):
    """Two rooms, a door between them: light comes through it from a lamp or from windows of the other."""
    b = Building(rng, "A dark room beside a lit one")
    height, depth = rng.uniform(2.4, 3.2), rng.uniform(3, 5)
    wide, dark = rng.uniform(3, 5), rng.uniform(3, 6)
    leaf = rng.uniform(0.5, 1.4)
    at = rng.uniform(0.5, depth - leaf - 0.5)
    byLamp = rng.random() < 0.5
    holes = {"west": [] if byLamp else windows(rng, (0, depth), height, 2, rng.uniform(0.3, 0.6)), "east": [(at, at + leaf, 0.02, 2.1)], "south": [], "north": []}
    b.room((0.0, wide), (0.0, depth), height, holes)
    b.room((wide, wide + dark), (0.0, depth), height, {"east": [], "south": [], "north": []})
    b.furniture((0.0, wide), (0.0, depth), 4, 1.0)
    eye = (wide + dark - 0.5, rng.uniform(1.3, 1.7), rng.choice([0.5, depth - 0.5]))
    b.furniture((wide + 0.8, wide + dark), (0.0, depth), rng.randint(2, 6), 1.2, [eye])
    lamp = {"name": "lamp", "kind": "spot", "position": [0.4, round(height - 0.3, 2), round(depth / 2, 2)], "target": [round(wide * rng.uniform(0.6, 1.1), 2), 0.0, round(at + leaf / 2, 2)],
            "intensity": 60.0, "inner_cone_degrees": 25.0, "outer_cone_degrees": 35.0}
    return b.scene(eye, (wide, rng.uniform(0.8, 1.3), depth / 2), lamp if byLamp else sun(rng, (1, 0)))


def passage(rng):
    """A court in the sun, and a passage along it behind pillars or openings, under a wall as high as the court's."""
    b = Building(rng, "A passage beside a sunlit court")
    length, deep, height = rng.uniform(12, 24), rng.uniform(2.5, 4), rng.uniform(2.8, 4.5)
    court, top = rng.uniform(5, 10), rng.uniform(6, 12)
    number = rng.randint(3, 8)
    open_ = rng.uniform(0.15, 0.75)
    step = length / number
    holes = [(step * (i + 0.5 - open_ / 2), step * (i + 0.5 + open_ / 2), rng.choice([0.02, 0.02, 0.9]), height - rng.uniform(0.2, 0.8)) for i in range(number)]
    b.room((0.0, length), (0.0, deep), height, {"west": [], "east": [], "south": [], "north": holes})
    paint = b.material(0.4, 0.7, 0.2)
    b.box((-THICK, height + THICK, deep - THICK / 2), (length + THICK, top, deep + THICK / 2), paint)
    b.box((-THICK, 0, deep + court), (length + THICK, top, deep + court + THICK), b.material(0.4, 0.7, 0.3))
    for x in (-THICK, length):
        b.box((x, 0, deep), (x + THICK, top, deep + court), paint)
    for _ in range(rng.randint(2, 6)):  # curtains
        x, w = rng.uniform(0, length - 1.5), rng.uniform(0.6, 1.4)
        b.box((x, rng.uniform(0.0, 1.2), deep + 0.15), (x + w, height, deep + 0.17), b.material(0.2, 0.6, 0.7))
    eye = (rng.uniform(0.6, 2.0), rng.uniform(1.4, 1.8), deep * rng.uniform(0.3, 0.6))
    b.furniture((0.0, length), (0.2, deep - 0.2), rng.randint(2, 6), 1.0, [eye])
    return b.scene(eye, (length, rng.uniform(1.2, 2.0), deep * rng.uniform(0.3, 0.9)), sun(rng, (rng.uniform(-0.3, 0.3), rng.choice([-0.35, 0.35]))))


def blinds(rng):
    """A room whose windows have slats."""
    b = Building(rng, "A room behind blinds")
    x, z, height = (0.0, rng.uniform(4, 7)), (0.0, rng.uniform(3.5, 6)), rng.uniform(2.6, 3.4)
    holes = windows(rng, z, height, rng.randint(1, 3), rng.uniform(0.4, 0.75))
    b.room(x, z, height, {"west": holes, "east": [], "south": [], "north": []})
    slat, paint = rng.uniform(0.08, 0.2), b.material(0.5, 0.8, 0.1)
    for a, c, sill, lintel in holes:
        y = sill
        while y < lintel:
            b.box((x[0] - 0.05, y, a), (x[0] + 0.05, min(y + slat * rng.uniform(0.4, 0.6), lintel), c), paint)
            y += slat
    eye = (x[1] - 0.5, rng.uniform(1.3, 1.8), z[1] - 0.5)
    b.furniture(x, z, rng.randint(5, 10), 1.3, [eye])
    return b.scene(eye, (x[0] + rng.uniform(0, 1.5), rng.uniform(0.5, 1.2), z[0] + rng.uniform(0, 2)), sun(rng, (1, 0)))


def blocks(rng):
    """Walls and blocks in the open."""
    b = Building(rng, "Blocks under the sun")
    size = rng.uniform(4, 8)
    for _ in range(rng.randint(0, 3)):
        axis, at, half = rng.choice([0, 2]), rng.uniform(-0.3, 0.3) * size, rng.uniform(0.2, 0.5) * size
        b.wall(axis, at, (-half, half), rng.uniform(1.5, 4), [], b.material(0.4, 0.8, 0.5))
    b.furniture((-size / 2, size / 2), (-size / 2, size / 2), rng.randint(5, 16), 1.5)
    turn = rng.choice([-1, 1])
    return b.scene((turn * size * 0.4, rng.uniform(1.2, 2.4), size * 0.5), (0, 0.4, 0), sun(rng, (turn * 0.5, -0.3)))


def lamp(rng):
    """A closed room with a lamp in it: nothing is far from what is lit."""
    b = Building(rng, "A room lit by its own lamp")
    x, z, height = (0.0, rng.uniform(3, 9)), (0.0, rng.uniform(3, 7)), rng.uniform(2.4, 5)
    b.room(x, z, height, {"west": [], "east": [], "south": [], "north": []})
    eye = (rng.uniform(0.4, 0.8), rng.uniform(1.2, 1.8), rng.uniform(0.4, 0.8))
    b.furniture(x, z, rng.randint(3, 9), rng.uniform(1, 2.2), [eye])
    place = (rng.uniform(0.35, 0.75) * x[1], height - 0.1, rng.uniform(0.3, 0.7) * z[1])
    target = (rng.uniform(0.2, 0.8) * x[1], rng.choice([0.0, 0.0, 1.0]), rng.uniform(0.2, 0.8) * z[1])
    half = rng.uniform(25, 60)
    return b.scene(eye, (x[1], rng.uniform(0.6, 1.2), z[1]), {"name": "lamp", "kind": "spot", "position": [round(v, 2) for v in place], "target": [round(v, 2) for v in target],
                                                              "intensity": 60.0, "inner_cone_degrees": round(half * 0.8, 1), "outer_cone_degrees": round(half, 1)})


def draw():
    """All scenes side by side, lit by one configuration of the planner's table."""
    import matplotlib.pyplot as plt
    import numpy as np

    import program
    options = program.read_options(__doc__, [], 0)
    call = program.caller(options.lightwell)
    pictures = []
    for path in write(options.work / "made"):
        picture = path.with_suffix(".png")
        call("render", path, "--technique", "ssvp", "--set", "vpls=1024", "clusters=64", "visibility=strict", "bounces=4", "resolution=half", "--size", "200x112", "--frames", 1, "--out", picture)
        pictures.append(plt.imread(picture)[:, :, :3])
    rows = [np.concatenate(pictures[i:i + 6], axis=1) for i in range(0, len(pictures), 6)]
    out = program.ROOT / "docs/images/planner_made.jpg"
    plt.imsave(out, np.ascontiguousarray(np.concatenate(rows)), pil_kwargs={"quality": 88})
    print(out)


if __name__ == "__main__":
    draw()
