#!/usr/bin/env python3
"""Makes the committed frame of tests/foreign: one view and one spot light of an engine that does
everything the other way round.

  world            left-handed, +y up, centimetres
  clip space       depth only, reversed z: 1 at the near plane; 0 at infinity (view) or the far plane (RSM)
  images           bottom row first in memory
  view normals     octahedral, two snorm16; rsm normals float4

It shares no code with Lightwell, its studio or its tests: rays are intersected analytically, matrices are
built from the camera's axes, and the expected irradiance is a double-precision sum over all texels of

    E = sum (flux / pi) * cosEmitter * cosReceiver / (d^2 + (1 + 3 cosEmitter^2) / 4 * area / pi)

at the receivers' exact positions (not at what their depth unprojects to). Only Python's standard library.

  python3 make_frame.py [FOLDER]     (default: the folder `frame` beside this file)
"""

import math
import struct
import sys
from pathlib import Path

# ------------------------------------------------------------------------------------------ vectors


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return mul(a, 1.0 / math.sqrt(dot(a, a)))


# -------------------------------------------------------------------------------------------- scene

ROOM_MIN, ROOM_MAX = (-200.0, 0.0, -150.0), (200.0, 260.0, 350.0)  # cm
BLOCK_MIN, BLOCK_MAX = (20.0, 0.0, 120.0), (110.0, 90.0, 230.0)
BALL_CENTER, BALL_RADIUS = (-110.0, 150.0, 230.0), 35.0
# A window in the far wall (z maximum), as x and y ranges: rays through it hit nothing.
WINDOW = ((120.0, 180.0), (140.0, 220.0))
WHITE, RED, GREEN = (0.7, 0.7, 0.7), (0.65, 0.08, 0.05), (0.1, 0.5, 0.12)
WOOD, BLUE = (0.5, 0.35, 0.2), (0.1, 0.2, 0.6)


def hit_room(origin, ray):
    """Nearest wall seen from inside: (distance, inward normal, albedo), or None through the window."""
    best = None
    for axis in range(3):
        if ray[axis] == 0.0:
            continue
        wall = ROOM_MAX[axis] if ray[axis] > 0.0 else ROOM_MIN[axis]
        distance = (wall - origin[axis]) / ray[axis]
        if best is None or distance < best[0]:
            normal = [0.0, 0.0, 0.0]
            normal[axis] = -math.copysign(1.0, ray[axis])
            best = (distance, tuple(normal), axis)
    distance, normal, axis = best
    point = add(origin, mul(ray, distance))
    if axis == 2 and normal[2] < 0.0:
        if WINDOW[0][0] < point[0] < WINDOW[0][1] and WINDOW[1][0] < point[1] < WINDOW[1][1]:
            return None
    albedo = WHITE
    if axis == 0:
        albedo = RED if normal[0] > 0.0 else GREEN
    elif axis == 1 and normal[1] > 0.0:
        albedo = WOOD
    return distance, normal, albedo


def hit_block(origin, ray):
    enter, leave, normal = -math.inf, math.inf, None
    for axis in range(3):
        if ray[axis] == 0.0:
            if not BLOCK_MIN[axis] <= origin[axis] <= BLOCK_MAX[axis]:
                return None
            continue
        sides = (BLOCK_MIN[axis], BLOCK_MAX[axis]) if ray[axis] > 0.0 else (BLOCK_MAX[axis], BLOCK_MIN[axis])
        near, far = ((side - origin[axis]) / ray[axis] for side in sides)
        if near > enter:
            enter = near
            facing = [0.0, 0.0, 0.0]
            facing[axis] = -math.copysign(1.0, ray[axis])
            normal = tuple(facing)
        leave = min(leave, far)
    if enter <= 0.0 or enter >= leave:
        return None
    return enter, normal, BLUE


def hit_ball(origin, ray):
    from_center = sub(origin, BALL_CENTER)
    a, b = dot(ray, ray), dot(from_center, ray)
    root = b * b - a * (dot(from_center, from_center) - BALL_RADIUS * BALL_RADIUS)
    if root < 0.0:
        return None
    distance = (-b - math.sqrt(root)) / a
    if distance <= 0.0:
        return None
    return distance, unit(add(from_center, mul(ray, distance))), WHITE


def trace(origin, ray):
    """Nearest surface along the ray: (position, normal, albedo), or None."""
    hits = [hit for hit in (hit_room(origin, ray), hit_block(origin, ray), hit_ball(origin, ray)) if hit]
    if not hits:
        return None
    distance, normal, albedo = min(hits, key=lambda hit: hit[0])
    return add(origin, mul(ray, distance)), normal, albedo


# ------------------------------------------------------------------------------------------ cameras


class Camera:
    """Left-handed: +x right, +y up, +z into the picture. Perspective with reversed z."""

    def __init__(self, eye, target, tan_x, tan_y, near, far):
        self.eye, self.tan_x, self.tan_y = eye, tan_x, tan_y
        self.forward = unit(sub(target, eye))
        self.right = unit(cross((0.0, 1.0, 0.0), self.forward))  # left-handed: up x forward
        self.up = cross(self.forward, self.right)
        # depth = a + b / z:  1 at z = near, 0 at z = far
        if far is None:
            self.a, self.b = 0.0, near
        else:
            self.a, self.b = -near / (far - near), near * far / (far - near)

    def ray(self, x, y):
        """Through clip coordinates (x, y); unit length along the axis, not in space."""
        return add(self.forward, add(mul(self.right, x * self.tan_x), mul(self.up, y * self.tan_y)))

    def depth(self, position):
        return self.a + self.b / dot(sub(position, self.eye), self.forward)

    def matrices(self):
        view = []
        for axis in (self.right, self.up, self.forward):
            view += [*axis, -dot(axis, self.eye)]
        view += [0.0, 0.0, 0.0, 1.0]
        projection = [1.0 / self.tan_x, 0.0, 0.0, 0.0, 0.0, 1.0 / self.tan_y, 0.0, 0.0,
                      0.0, 0.0, self.a, self.b, 0.0, 0.0, 1.0, 0.0]
        return view, projection


def pixels(width, height):
    """Column, row from the bottom, and the centre in clip coordinates; in memory's order."""
    for row in range(height):
        for column in range(width):
            yield column, row, 2.0 * (column + 0.5) / width - 1.0, 2.0 * (row + 0.5) / height - 1.0


def octahedral(n):
    """The unit vector folded onto a square about the z axis: two snorm16."""
    scale = 1.0 / (abs(n[0]) + abs(n[1]) + abs(n[2]))
    x, y = n[0] * scale, n[1] * scale
    if n[2] < 0.0:
        x, y = math.copysign(1.0 - abs(y), x), math.copysign(1.0 - abs(x), y)
    return round(x * 32767.0), round(y * 32767.0)


# ----------------------------------------------------------------------------------- the two images

VIEW_SIZE, RSM_SIZE = (160, 90), (64, 64)
SPOT_INTENSITY = (900.0, 800.0, 700.0)  # W/sr on the axis
SPOT_INNER, SPOT_OUTER = math.radians(18.0), math.radians(28.0)
LEAST_LIGHT_COSINE = 0.1


def draw_view(camera):
    depth, normals, receivers = bytearray(), bytearray(), []
    for column, row, x, y in pixels(*VIEW_SIZE):
        hit = trace(camera.eye, camera.ray(x, y))
        depth += struct.pack("<f", camera.depth(hit[0]) if hit else 0.0)
        normals += struct.pack("<2h", *(octahedral(hit[1]) if hit else (0, 0)))
        receivers.append((column, row, hit))
    return depth, normals, receivers


def spot_intensity(cosine):
    """Falls from the inner to the outer cone as glTF's KHR_lights_punctual has it."""
    inner, outer = math.cos(SPOT_INNER), math.cos(SPOT_OUTER)
    return min(1.0, max(0.0, (cosine - outer) / (inner - outer))) ** 2


def draw_rsm(camera):
    width, height = RSM_SIZE
    texel_area = (2.0 * camera.tan_x / width) * (2.0 * camera.tan_y / height)  # at unit distance
    depth, normals, fluxes, emitters = bytearray(), bytearray(), bytearray(), []
    for _, _, x, y in pixels(width, height):
        ray = camera.ray(x, y)
        hit = trace(camera.eye, ray)
        cosine = 1.0 / math.sqrt(dot(ray, ray))
        share = spot_intensity(cosine)
        depth += struct.pack("<f", camera.depth(hit[0]) if hit else 0.0)
        if hit is None or share == 0.0:
            normals += struct.pack("<4f", 0.0, 0.0, 0.0, 0.0)
            fluxes += struct.pack("<3f", 0.0, 0.0, 0.0)
            continue
        position, normal, albedo = hit
        solid_angle = texel_area * cosine**3
        to_light = sub(camera.eye, position)
        light_cosine = dot(unit(to_light), normal)
        # Grazing texels are bounded by a constant of the library's own choice; this frame has none.
        assert light_cosine > LEAST_LIGHT_COSINE, (position, light_cosine)
        area = solid_angle * dot(to_light, to_light) / light_cosine
        flux = tuple(a * i * share * solid_angle for a, i in zip(albedo, SPOT_INTENSITY))
        normals += struct.pack("<4f", *normal, 1.0)
        fluxes += struct.pack("<3f", *flux)
        emitters.append((position, normal, flux, area))
    return depth, normals, fluxes, emitters


def gather(position, normal, emitters):
    total = [0.0, 0.0, 0.0]
    for emitter_position, emitter_normal, flux, area in emitters:
        way = sub(emitter_position, position)
        squared = dot(way, way)
        if squared == 0.0:
            continue
        distance = math.sqrt(squared)
        receiver_cosine = dot(normal, way) / distance
        emitter_cosine = -dot(emitter_normal, way) / distance
        if receiver_cosine <= 0.0 or emitter_cosine <= 0.0:
            continue
        factor = emitter_cosine * receiver_cosine / (squared + (1.0 + 3.0 * emitter_cosine**2) / 4.0 * area / math.pi) / math.pi
        for channel in range(3):
            total[channel] += flux[channel] * factor
    return total


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "frame"
    folder.mkdir(parents=True, exist_ok=True)
    view = Camera((-60.0, 130.0, -130.0), (30.0, 95.0, 200.0), 0.9, 0.9 * 90 / 160, 5.0, None)
    spread = math.tan(SPOT_OUTER)
    rsm = Camera((60.0, 250.0, 20.0), (90.0, 0.0, 150.0), spread, spread, 10.0, 900.0)

    view_depth, view_normal, receivers = draw_view(view)
    rsm_depth, rsm_normal, rsm_flux, emitters = draw_rsm(rsm)
    for name, data in (("view_depth.f32", view_depth), ("view_normal.oct16x2", view_normal),
                       ("rsm_depth.f32", rsm_depth), ("rsm_normal.f32x4", rsm_normal),
                       ("rsm_flux.f32x3", rsm_flux)):
        (folder / name).write_bytes(data)

    lines = []

    def put(key, values):
        lines.append(" ".join([key, *(repr(value) for value in values)]))

    for name, camera, size in (("view", view, VIEW_SIZE), ("rsm", rsm, RSM_SIZE)):
        put(name + "_size", size)
        matrices = camera.matrices()
        put(name + "_view", matrices[0])
        put(name + "_projection", matrices[1])
    put("spot_position", rsm.eye)
    put("spot_direction", rsm.forward)
    put("spot_intensity", SPOT_INTENSITY)
    put("spot_half_angles", (SPOT_INNER, SPOT_OUTER))
    # Every 7th pixel of every 6th row, and the window's: column, row from the bottom, irradiance W/cm^2.
    chosen = [r for r in receivers if r[0] % 7 == 3 and r[1] % 6 == 2]
    put("expected_count", (len(chosen),))
    for column, row, hit in chosen:
        put(f"{column} {row}", gather(hit[0], hit[1], emitters) if hit else (0.0, 0.0, 0.0))
    (folder / "frame.txt").write_text("\n".join(lines) + "\n")
    print(f"{len(emitters)} lit texels, {len(chosen)} pixels in {folder}")


if __name__ == "__main__":
    main()
