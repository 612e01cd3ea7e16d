"""Cameras as two 4 x 4 matrices, row-major, multiplying column vectors: clip = projection @ view @ (x, y, z, 1)."""
from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import instance, numbers
from ._errors import InvalidArgumentError


@dataclasses.dataclass(frozen=True, eq=False)
class Camera:
    """`view`: world to view; `projection`: view to clip, perspective or orthographic, +y up."""

    view: ArrayLike
    projection: ArrayLike


def _vector(values: ArrayLike, name: str) -> NDArray[np.float64]:
    vector = numbers(values, (3,), name)
    if not np.isfinite(vector).all():
        raise InvalidArgumentError(f"{name}: expected three finite numbers, got {values!r}")
    return vector


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> NDArray[np.float64]:
    """The view matrix of a right-handed camera at `eye` that looks down its own -z at `target`."""
    origin = _vector(eye, "eye")
    back = origin - _vector(target, "target")
    right = np.cross(_vector(up, "up"), back)
    if not np.linalg.norm(right) > 0.0:
        raise InvalidArgumentError(f"look_at: expected an eye beside its target and an up that is not the way it looks, got {eye!r}, "
                                   f"{target!r}, {up!r}")
    back /= np.linalg.norm(back)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = rotation, -rotation @ origin
    return view


def perspective(vertical_angle: float, aspect: float, near: float = 0.1, far: float = 1000.0) -> NDArray[np.float64]:
    """`vertical_angle` in radians, `aspect` = width / height; clip z / w runs from 0 at `near` to 1 at `far`."""
    if not (0.0 < vertical_angle < math.pi and aspect > 0.0 and 0.0 < near < far):
        raise InvalidArgumentError("perspective: expected an angle in (0, pi), an aspect above 0 and 0 < near < far, got "
                                   f"{vertical_angle}, {aspect}, {near}, {far}")
    scale = 1.0 / math.tan(0.5 * vertical_angle)
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1], matrix[3, 2] = scale / aspect, scale, -1.0
    matrix[2, 2], matrix[2, 3] = far / (near - far), near * far / (near - far)
    return matrix


def orthographic(width: float, height: float, near: float = 0.0, far: float = 1000.0) -> NDArray[np.float64]:
    """A box of `width` x `height` about the camera's axis, of a directional light; clip z runs from 0 at `near` to 1 at `far`."""
    if not (width > 0.0 and height > 0.0 and near < far):
        raise InvalidArgumentError(f"orthographic: expected sizes above 0 and near < far, got {width}, {height}, {near}, {far}")
    matrix = np.eye(4)
    matrix[0, 0], matrix[1, 1] = 2.0 / width, 2.0 / height
    matrix[2, 2], matrix[2, 3] = 1.0 / (near - far), near / (near - far)
    return matrix


def fill_camera(target: Any, camera: "Camera | None", name: str) -> None:
    if camera is None:
        return
    instance(camera, Camera, name)
    for field in ("view", "projection"):
        getattr(target, field)[0:16] = numbers(getattr(camera, field), (4, 4), f"{name}.{field}").ravel().tolist()
