"""Arrays that the Python package's tests share: a wall lit by a sun beside a floor, and one texel before one receiver."""
import math

import numpy as np

import lightwell as lw

N = 24  # no multiple of 16: outputs have padding


def image(*channels):
    return np.stack(np.broadcast_arrays(*channels), -1).astype(np.float32)


def grid(n=N):
    t = (np.arange(n, dtype=np.float32) + 0.5) / n
    u, v = np.meshgrid(t, t)
    return u, v, np.zeros_like(u), np.ones_like(u)


def floor(n=N, **more):
    u, v, zero, one = grid(n)
    return lw.GBuffer(position=image(u, zero, v), normal=image(zero, one, zero), **more)


def sun_camera():
    return lw.Camera(lw.look_at((2, 0.5, 0.5), (0, 0.5, 0.5)), lw.orthographic(1, 1, 0, 4))


def wall(n=N):
    u, v, zero, one = grid(n)
    return lw.Rsm(position=image(zero, 1 - v, 1 - u), normal=image(one, zero, zero),
                  flux=image(one, 0.5 * one, u) / np.float32(n * n), camera=sun_camera())


def sun(rsms):
    return lw.Light.directional((-1, 0, 0), (1, 1, 1), rsms=rsms)


def frame(n=N):
    return lw.Frame(lights=[sun([wall(n)])])


def single(values, channels=3):
    """A picture of one pixel."""
    return np.array(values, np.float32).reshape(1, 1, channels)


def texel(flux, side, normal=(0, 1, 0), position=(0, 0, 0)):
    """One texel: a square of `side` m lit straight from above, sending `flux` W in each colour."""
    camera = lw.Camera(lw.look_at((0, 5, 0), (0, 0, 0), (0, 0, -1)), lw.orthographic(side, side, 0, 10))
    rsm = lw.Rsm(position=single(position), normal=single(normal), flux=single([flux] * 3), camera=camera)
    return lw.Light.directional((0, -1, 0), (flux / side**2,) * 3, rsms=[rsm])


def receiver(position, normal):
    unit = np.array(normal, np.float64) / math.sqrt(sum(x * x for x in normal))
    return lw.GBuffer(position=single(position), normal=single(unit))
