"""The scenes that blender.py and mitsuba3.py build: plain numbers, no imports of either program.

Lengths in metres, Z up, right-handed, as Blender has them; mitsuba3.py turns them to Y up. A surface is four corners, counter-clockwise seen from
its lit side, and a diffuse reflectance. The room is a box that is open to the camera, with two blocks; without
them (`empty`) nothing hides anything, and a gather without visibility has the truth. `sphere` is the analytic case: inside a
sphere of reflectance rho the irradiance of a lamp of intensity I at the centre is I / R^2 on every point, and each bounce is rho times the one before.
"""
import argparse
import math

WHITE, RED, GREEN = (0.725, 0.725, 0.725), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)


def options(description, arguments):
    """What both scripts are told."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    parser.add_argument("--scene", default="spot", choices=["spot", "empty", "sun", "sphere"])
    parser.add_argument("--size", default="384x256")
    parser.add_argument("--rsm", type=int, default=256)
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--half", action="store_true")
    return parser.parse_args(arguments)


def quad(a, b, c, d, colour):
    return ([a, b, c, d], colour)


def block(x, y, width, height, degrees, colour=WHITE):
    """A box on the floor, turned about its axis; without its bottom."""
    turn = math.radians(degrees)
    ring = []
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        u, v = sx * width / 2, sy * width / 2
        ring.append((x + u * math.cos(turn) - v * math.sin(turn), y + u * math.sin(turn) + v * math.cos(turn)))
    low, high = [(*p, 0.0) for p in ring], [(*p, height) for p in ring]
    sides = [quad(low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i], colour) for i in range(4)]
    return sides + [quad(*high, colour)]


def room_surfaces(blocks=True):
    l, r, f, b, t = -1.0, 1.0, -1.0, 1.0, 2.0  # left, right, front, back, top
    return [quad((l, f, 0), (r, f, 0), (r, b, 0), (l, b, 0), WHITE),  # floor
            quad((l, f, t), (l, b, t), (r, b, t), (r, f, t), WHITE),  # ceiling
            quad((l, b, 0), (r, b, 0), (r, b, t), (l, b, t), WHITE),  # back
            quad((l, f, 0), (l, b, 0), (l, b, t), (l, f, t), RED),
            quad((r, f, 0), (r, f, t), (r, b, t), (r, b, 0), GREEN),
            *(block(-0.35, 0.3, 0.6, 1.2, 17.0) + block(0.35, -0.3, 0.6, 0.6, -18.0) if blocks else [])]


# Eye, the point looked at, up; whole vertical angle. 3 : 2 pictures show some black outside of the room. Off the middle, or rays through pixels
# would meet the edges where two walls join.
CAMERA = {"position": (0.13, -3.5, 1.08), "target": (0.02, 0.0, 0.97), "up": (0.0, 0.0, 1.0), "vertical_fov_degrees": 48.0}
SPOT = {"kind": "spot", "position": (0.45, -0.75, 1.8), "target": (-0.55, 0.45, 0.35), "up": (0.0, 0.0, 1.0),
        "outer_cone_degrees": 32.0, "intensity": (10.0, 10.0, 10.0)}
# Through the open side; a square of `extent` metres a side around the middle of its rays holds the whole room.
SUN = {"kind": "sun", "direction": (-0.35, 0.8, -0.48), "up": (0.0, 0.0, 1.0), "irradiance": (5.0, 5.0, 5.0), "centre": (0.0, 0.0, 1.0),
       "extent": 3.6, "distance": 4.0}
SPHERE = {"radius": 1.5, "reflectance": 0.5, "intensity": 2.0}
SPHERE_CAMERA = {"position": (0.4, -0.7, 0.3), "target": (0.0, 0.5, 0.0), "up": (0.0, 0.0, 1.0), "vertical_fov_degrees": 70.0}
# Six looks out of the sphere's centre: a point light's faces.
FACES = [((1, 0, 0), (0, 0, 1)), ((-1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)), ((0, 0, 1), (0, 1, 0)),
         ((0, 0, -1), (0, 1, 0))]


def minus(a, b):
    return tuple(p - q for p, q in zip(a, b))


def plus(a, b):
    return tuple(p + q for p, q in zip(a, b))


def times(a, factor):
    return tuple(p * factor for p in a)


def unit(a):
    return times(a, 1.0 / math.sqrt(sum(p * p for p in a)))


def sun_eye():
    """Where the orthographic camera of the sun's map stands."""
    return plus(SUN["centre"], times(unit(SUN["direction"]), -SUN["distance"]))
