"""A renderer of a few dozen lines of NumPy before Lightwell: a room with a ball and a spot lamp, drawn by ray casting; the planner's
choice lights what the lamp does not reach. Leaves room.png: direct light | with indirect light.

    python3 room.py [--size 640x480] [--budget-ms 50 | --technique "rsm vpls=512"]
"""
import argparse
import math

import matplotlib.pyplot
import numpy as np

import lightwell as lw

LOWER, UPPER = np.array([-2.0, 0.0, -2.0]), np.array([2.0, 3.0, 4.0])  # the room, m
WALLS = np.array([[[0.6, 0.1, 0.08], [0.12, 0.4, 0.1]], [[0.6, 0.55, 0.5], [0.8, 0.8, 0.8]], [[0.75, 0.75, 0.72], [0.7, 0.7, 0.75]]])
BALL, RADIUS, BALL_ALBEDO = np.array([0.4, 0.7, -0.6]), 0.7, np.array([0.8, 0.75, 0.6])
LAMP, LAMP_DIRECTION, INTENSITY, CONE = np.array([1.2, 2.6, 1.5]), np.array([-0.75, -0.45, -0.45]), 60.0, math.radians(40)


def cast(origins, directions):
    """What rays meet first: distance along them, normal, albedo."""
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(directions > 0, UPPER, LOWER)
        steps = np.where(directions != 0, (far - origins) / directions, np.inf)
    axis = steps.argmin(-1)
    distance = np.take_along_axis(steps, axis[..., None], -1)[..., 0]
    side = (np.take_along_axis(directions, axis[..., None], -1)[..., 0] > 0).astype(int)
    normal = np.eye(3)[axis] * np.where(side, -1.0, 1.0)[..., None]
    albedo = WALLS[axis, side]
    b = ((origins - BALL) * directions).sum(-1)
    length2 = (directions**2).sum(-1)
    under = b * b - length2 * (((origins - BALL) ** 2).sum(-1) - RADIUS**2)
    near = (-b - np.sqrt(np.maximum(under, 0))) / length2
    hits = (under > 0) & (near > 1e-4) & (near < distance)
    distance = np.where(hits, near, distance)
    on_ball = (origins + distance[..., None] * directions - BALL) / RADIUS
    return distance, np.where(hits[..., None], on_ball, normal), np.where(hits[..., None], BALL_ALBEDO, albedo)


def draw(camera, eye, width, height):
    """Positions, normals, albedos of a picture, and its rays at unit distance along the axis."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    projection = np.asarray(camera.projection)
    rays = np.stack([x / projection[0, 0], y / projection[1, 1], -np.ones_like(x)], -1)
    world = rays @ np.asarray(camera.view)[:3, :3]
    distance, normal, albedo = cast(eye, world)
    return [array.astype(np.float32) for array in (eye + distance[..., None] * world, normal, albedo)] + [rays]


def spot(direction):
    """The lamp's intensity towards a direction, as KHR_lights_punctual has it with an inner angle of 0: W/sr."""
    cosine = direction @ (LAMP_DIRECTION / np.linalg.norm(LAMP_DIRECTION)) / np.linalg.norm(direction, axis=-1)
    return INTENSITY * np.clip((cosine - math.cos(CONE)) / (1 - math.cos(CONE)), 0, 1) ** 2


def direct_radiance(position, normal, albedo):
    """L_d of every pixel, with the lamp's hard shadow."""
    from_lamp = position.astype(np.float64) - LAMP
    squared = (from_lamp**2).sum(-1)
    cosine = np.clip(-(from_lamp * normal).sum(-1) / np.sqrt(squared), 0, None)
    seen = cast(LAMP, from_lamp)[0] > 0.999
    return (albedo / math.pi * (spot(from_lamp) * cosine * seen / squared)[..., None]).astype(np.float32)


def lamp(size=256):
    """The light with its reflective shadow map."""
    camera = lw.Camera(lw.look_at(LAMP, LAMP + LAMP_DIRECTION), lw.perspective(2 * CONE, 1, 0.05, 20))
    position, normal, albedo, rays = draw(camera, LAMP, size, size)
    solid_angle = (2 * math.tan(CONE) / size) ** 2 / (rays**2).sum(-1) ** 1.5  # of a texel, sr
    flux = (albedo * (spot(position - LAMP) * solid_angle)[..., None]).astype(np.float32)
    rsm = lw.Rsm(position=position, normal=normal, flux=flux, camera=camera)
    return lw.Light.spot(tuple(LAMP), tuple(LAMP_DIRECTION), (INTENSITY,) * 3, 0.0, CONE, rsms=[rsm])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--budget-ms", type=float, default=50.0)
    parser.add_argument("--technique", default="", help="a name and settings instead of the planner's choice")
    options = parser.parse_args()
    width, height = (int(side) for side in options.size.split("x"))
    eye = np.array([0.0, 1.5, 3.8])
    camera = lw.Camera(lw.look_at(eye, (0, 1.3, -1)), lw.perspective(math.radians(55), width / height))
    position, normal, albedo, _ = draw(camera, eye, width, height)
    direct = direct_radiance(position, normal, albedo)
    gbuffer = lw.GBuffer(position=position, normal=normal, albedo=albedo, direct_radiance=direct, camera=camera, previous_camera=camera)
    with lw.Device() as device:
        view = device.view(width, height)
        frame = lw.Frame(lights=[lamp()], source_views=[(view, gbuffer)])
        for finding in view.check_inputs(frame, gbuffer):
            print(finding.severity.name, finding.message)
        name, _, settings = options.technique.partition(" ")
        if not name:
            plan = view.plan(frame, gbuffer, budget_ms=options.budget_ms)
            name, settings = plan.technique, plan.parameters
            print(f"{name} {settings}: {plan.reason}")
        technique = device.technique_from_text(name, settings)
        technique.update(frame)
        irradiance = technique.render(view, gbuffer).irradiance
        print(f"{device.info.name}: {technique.stats()['total_ms']:.1f} ms")
    both = np.hstack([direct, direct + albedo / math.pi * irradiance])
    matplotlib.pyplot.imsave("room.png", np.clip(both / (both + 0.6), 0, 1) ** (1 / 2.2))


if __name__ == "__main__":
    main()
