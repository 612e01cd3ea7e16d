"""Pictures for gi_test.py that need no renderer: the inside of a sphere with a lamp in its middle, in the channels of Blender and of Mitsuba."""
import math


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def plus(a, b, factor=1.0):
    return tuple(p + factor * q for p, q in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


class Camera:
    """Rays of a pinhole, from its eye, forward and right (unit), and the tangent of half of its vertical angle."""

    def __init__(self, eye, forward, right, tangent):
        self.eye, self.forward, self.right, self.up, self.tangent = eye, forward, right, cross(right, forward), tangent

    def rays(self, width, height):
        for y in range(height):
            for x in range(width):
                u, v = (2 * (x + 0.5) / width - 1) * self.tangent * width / height, (1 - 2 * (y + 0.5) / height) * self.tangent
                yield plus(plus(self.forward, self.right, u), self.up, v)

    def keys(self, axes):
        columns = {"blender": (self.right, self.up, plus((0, 0, 0), self.forward, -1)),
                   "mitsuba": (plus((0, 0, 0), self.right, -1), self.up, self.forward)}[axes]
        matrix = [[*(column[row] for column in columns), self.eye[row]] for row in range(3)] + [[0, 0, 0, 1]]
        return {"to_world": [value for row in matrix for value in row], "axes": axes,
                "vertical_fov_degrees": 2 * math.degrees(math.atan(self.tangent))}


FACES = [((1, 0, 0), (0, 1, 0)), ((-1, 0, 0), (0, 1, 0)), ((0, 1, 0), (1, 0, 0)), ((0, -1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 0)),
         ((0, 0, -1), (1, 0, 0))]
RADIUS, RHO, INTENSITY = 1.5, 0.5, 2.0
SIZE, MAP = (12, 8), 16


def sphere_picture(camera, width, height, to_planes):
    """Positions inside the sphere around the origin, and what `to_planes` makes of camera, ray and position."""
    planes = {}
    for ray in camera.rays(width, height):
        a, b, c = dot(ray, ray), dot(camera.eye, ray), dot(camera.eye, camera.eye) - RADIUS ** 2
        place = plus(camera.eye, ray, (-b + math.sqrt(b * b - a * c)) / a)
        for name, value in to_planes(camera, ray, place).items():
            planes.setdefault(name, []).append(value)
    return planes


def blender_planes(camera, ray, place):
    normal = [-p / RADIUS for p in place]
    direct = INTENSITY / RADIUS ** 2 / math.pi  # DiffDir is irradiance over pi, without the colour
    planes = {"ViewLayer.Combined.%s" % c: 0.25 for c in "RGBA"}
    for i, c in enumerate("XYZ"):
        planes["ViewLayer.Position." + c], planes["ViewLayer.Normal." + c] = place[i], normal[i]
    for c in "RGB":
        planes["ViewLayer.DiffCol." + c], planes["ViewLayer.DiffDir." + c] = RHO, direct
    return planes


NEAR = 0.05


def mitsuba_planes(camera, ray, place):
    """Depth instead of positions: along the ray, from the near plane; normals of a one-sided surface point outwards here."""
    normal = [p / RADIUS for p in place]
    along = dot(plus(place, camera.eye, -1), camera.forward)
    planes = {"depth.T": (along - NEAR) * math.sqrt(dot(ray, ray))}
    for i, c in enumerate("XYZ"):
        planes["nn." + c] = normal[i]
    for c in "RGB":
        planes["albedo." + c], planes["direct." + c] = RHO, RHO / math.pi * INTENSITY / RADIUS ** 2
    return planes
