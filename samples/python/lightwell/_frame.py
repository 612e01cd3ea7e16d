"""What a host gives, as dataclasses over arrays, and how they become the library's structs.

Fields are the header's in snake_case, with its units; what stays None is absent. Nothing is converted: arrays must have the
types that are named here, so that no copy hides.
"""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import choice, instance, numbers, real, sequence, whole
from ._camera import Camera, fill_camera
from ._enums import DepthKind, LightKind, Receivers
from ._errors import InvalidArgumentError
from ._images import Array, ImageLike, Kept, describe, fill_image, plain_array
from ._library import ffi
from ._records import BLOCKER, STATIC_VPL, VPL, records_pointer

if TYPE_CHECKING:
    from ._view import View

Vector = ArrayLike  # three numbers
_ORIGIN: Vector = (0.0, 0.0, 0.0)


@dataclasses.dataclass(eq=False)
class GBuffer:
    """One view's G-buffer: `normal`, and `position` or `depth` (with `camera`), are required."""

    position: Optional[ImageLike] = None
    depth: Optional[ImageLike] = None
    normal: Optional[ImageLike] = None
    albedo: Optional[ImageLike] = None
    direct_radiance: Optional[ImageLike] = None
    roughness: Optional[ImageLike] = None
    motion: Optional[ImageLike] = None
    receive_mask: Optional[ImageLike] = None
    baked_mask: Optional[ImageLike] = None
    camera: Optional[Camera] = None
    previous_camera: Optional[Camera] = None
    depth_kind: DepthKind = DepthKind.ZERO_TO_ONE


@dataclasses.dataclass(eq=False)
class Rsm:
    """One reflective shadow map; `flux` in W for each texel, `camera` orthographic for a directional light. `version` above 0, raised
    when pixels change: the same arrays are then not read again while it stays."""

    position: Optional[ImageLike] = None
    depth: Optional[ImageLike] = None
    normal: Optional[ImageLike] = None
    flux: Optional[ImageLike] = None
    camera: Optional[Camera] = None
    depth_kind: DepthKind = DepthKind.ZERO_TO_ONE
    version: int = 0


@dataclasses.dataclass(eq=False)
class Light:
    """A light and its RSMs. `directional`, `point` and `spot` make one with what that kind needs."""

    kind: LightKind
    position: Vector = _ORIGIN
    direction: Vector = _ORIGIN
    irradiance: Vector = _ORIGIN
    radiant_intensity: Vector = _ORIGIN
    inner_cone_angle: float = 0.0
    outer_cone_angle: float = 0.0
    rsms: Sequence[Rsm] = ()
    mask: int = 0
    receivers: Receivers = Receivers.ALL
    profile: Optional[NDArray[np.float32]] = None
    hit: Optional[Vector] = None

    @classmethod
    def directional(cls, direction: Vector, irradiance: Vector, rsms: Sequence[Rsm] = (), **more: Any) -> "Light":
        """`direction`: the way light travels; `irradiance`: of a plane that faces it, W/m^2."""
        return cls(LightKind.DIRECTIONAL, direction=direction, irradiance=irradiance, rsms=rsms, **more)

    @classmethod
    def point(cls, position: Vector, radiant_intensity: Vector, rsms: Sequence[Rsm] = (), **more: Any) -> "Light":
        """`radiant_intensity` in W/sr."""
        return cls(LightKind.POINT, position=position, radiant_intensity=radiant_intensity, rsms=rsms, **more)

    @classmethod
    def spot(cls, position: Vector, direction: Vector, radiant_intensity: Vector, inner_cone_angle: float,
             outer_cone_angle: float, rsms: Sequence[Rsm] = (), **more: Any) -> "Light":
        """Half angles in radians; `radiant_intensity` on the axis, W/sr."""
        return cls(LightKind.SPOT, position=position, direction=direction, radiant_intensity=radiant_intensity,
                   inner_cone_angle=inner_cone_angle, outer_cone_angle=outer_cone_angle, rsms=rsms, **more)


@dataclasses.dataclass(eq=False)
class Geometry:
    """Surfels: (n, 3) and (n,) float32 arrays. Triangles: `vertices` (v, 3) float32, `indices` (t, 3) uint32, albedo and emission
    (t, 3) float32. Raise `version` when any of them changes."""

    surfel_position: Optional[Array] = None
    surfel_normal: Optional[Array] = None
    surfel_albedo: Optional[Array] = None
    surfel_emission: Optional[Array] = None
    surfel_area: Optional[Array] = None
    vertices: Optional[Array] = None
    indices: Optional[Array] = None
    triangle_albedo: Optional[Array] = None
    triangle_emission: Optional[Array] = None
    version: int = 0


@dataclasses.dataclass(eq=False)
class Frame:
    """What `Technique.update` takes: the world part, once per frame. `vpls`, `static_vpls` and `blockers` are structured arrays
    (`vpls()`, `static_vpls()` and `blockers()` make them); `source_views` are pairs of a view and its G-buffer. All positions and
    matrices are relative to `world_origin`, three numbers that keep their 53 bits."""

    lights: Sequence[Light] = ()
    vpls: Optional[Array] = None
    static_vpls: Optional[Array] = None
    blockers: Optional[Array] = None
    source_views: Sequence[Tuple["View", GBuffer]] = ()
    geometry: Optional[Geometry] = None
    environment: Vector = _ORIGIN
    focus: Optional[Vector] = None
    world_origin: Vector = _ORIGIN
    index: int = 0
    reset: bool = False


def camel(name: str) -> str:
    """`direct_radiance` as the header has it."""
    first, *rest = name.split("_")
    return first + "".join(word.capitalize() for word in rest)


def new_struct(kind: str, kept: Optional[Kept] = None) -> Any:
    """A zeroed struct with its structSize set."""
    struct = ffi.new(kind + "*")
    struct.structSize = ffi.sizeof(kind)
    return kept.add(struct) if kept is not None else struct


def fill_vector(target: Any, values: Any, name: str) -> None:
    target[0:3] = numbers(values, (3,), name).tolist()


_PIXELS = ("position", "depth", "normal", "albedo", "direct_radiance", "roughness", "motion", "receive_mask", "baked_mask", "flux")


def _fill_pictures(target: Any, source: Any, name: str, kept: Kept) -> None:
    target.depthKind = choice(DepthKind, source.depth_kind, f"{name}.depth_kind")
    for field in _PIXELS:
        if hasattr(source, field):
            fill_image(getattr(target, camel(field)), getattr(source, field), f"{name}.{field}", kept)
    fill_camera(target.camera, source.camera, f"{name}.camera")


def gbuffer_struct(gbuffer: GBuffer, kept: Kept, name: str = "gbuffer") -> Any:
    instance(gbuffer, GBuffer, name)
    struct = new_struct("LWGBuffer", kept)
    _fill_pictures(struct, gbuffer, name, kept)
    fill_camera(struct.previousCamera, gbuffer.previous_camera, f"{name}.previous_camera")
    return struct


def _floats(values: Any, name: str, kept: Kept, columns: int = 0, kind: str = "float32") -> Tuple[Any, int]:
    """A packed array in host memory for as long as the call lasts: its pointer and its length."""
    array = plain_array(values, name)
    right_shape = array.ndim == 2 and array.shape[1] == columns if columns else array.ndim == 1
    if array.dtype != np.dtype(kind) or not right_shape:
        wanted = f"(n, {columns})" if columns else "(n,)"
        raise InvalidArgumentError(f"{name}: expected {kind} {wanted}, got {describe(array)}")
    if not array.flags.c_contiguous or not array.flags.aligned:
        array = np.array(array, order="C", copy=True)
        kept.copied += array.nbytes
    kept.add(array)
    return ffi.cast("uint32_t*" if kind == "uint32" else "float*", array.ctypes.data), len(array)


def _fill_light(target: Any, light: Light, name: str, kept: Kept) -> None:
    instance(light, Light, name)
    target.structSize = ffi.sizeof("LWLight")
    target.kind = choice(LightKind, light.kind, f"{name}.kind")
    for field in ("position", "direction", "irradiance", "radiant_intensity"):
        fill_vector(getattr(target, camel(field)), getattr(light, field), f"{name}.{field}")
    target.innerConeAngle = real(light.inner_cone_angle, f"{name}.inner_cone_angle")
    target.outerConeAngle = real(light.outer_cone_angle, f"{name}.outer_cone_angle")
    target.mask, target.receivers = whole(light.mask, f"{name}.mask"), choice(Receivers, light.receivers, f"{name}.receivers")
    if light.profile is not None:
        target.profile, target.profileCount = _floats(light.profile, f"{name}.profile", kept)
    if light.hit is not None:
        target.hit = kept.add(ffi.new("float[3]"))
        fill_vector(target.hit, light.hit, f"{name}.hit")
    rsms = kept.add(ffi.new("LWRsm[]", len(sequence(light.rsms, f"{name}.rsms", "Rsm"))))
    for index, rsm in enumerate(light.rsms):
        instance(rsm, Rsm, f"{name}.rsms[{index}]")
        rsms[index].structSize = ffi.sizeof("LWRsm")
        rsms[index].version = whole(rsm.version, f"{name}.rsms[{index}].version", high=2**64 - 1)
        _fill_pictures(rsms[index], rsm, f"{name}.rsms[{index}]", kept)
    target.rsms, target.rsmCount = rsms, len(light.rsms)


def _surfels(array: Array, name: str) -> Array:
    """(n, 3) or (n,) as one row of pixels."""
    array = plain_array(array, name)
    if array.ndim not in (1, 2):
        raise InvalidArgumentError(f"{name}: expected float32 (n, 3) or (n,), got {describe(array)}")
    return array[np.newaxis]


def _geometry_struct(geometry: Geometry, kept: Kept) -> Any:
    instance(geometry, Geometry, "frame.geometry")
    struct = new_struct("LWGeometry", kept)
    struct.version = whole(geometry.version, "frame.geometry.version", high=2**64 - 1)
    for field in ("surfel_position", "surfel_normal", "surfel_albedo", "surfel_emission", "surfel_area"):
        array = getattr(geometry, field)
        if array is not None:
            name = f"frame.geometry.{field}"
            fill_image(getattr(struct, camel(field)), _surfels(array, name), name, kept)
    if geometry.surfel_position is not None:
        struct.surfelCount = len(geometry.surfel_position)
    if geometry.vertices is not None:
        struct.vertices, struct.vertexCount = _floats(geometry.vertices, "frame.geometry.vertices", kept, 3)
        struct.triangleCount = struct.vertexCount // 3
    if geometry.indices is not None:
        struct.indices, struct.triangleCount = _floats(geometry.indices, "frame.geometry.indices", kept, 3, "uint32")
    for field in ("triangle_albedo", "triangle_emission"):
        array = getattr(geometry, field)
        if array is None:
            continue
        pointer, count = _floats(array, f"frame.geometry.{field}", kept, 3)
        if count != struct.triangleCount:  # the library would read past the array's end
            raise InvalidArgumentError(f"frame.geometry.{field}: expected {struct.triangleCount} rows, one a triangle, got {count}")
        setattr(struct, camel(field), pointer)
    return struct


def _sources(frame: Frame, kept: Kept) -> Tuple[Any, int]:
    pairs = sequence(frame.source_views, "frame.source_views", "pairs of a View and its GBuffer")
    sources = kept.add(ffi.new("LWSourceView[]", len(pairs)))
    for index, pair in enumerate(pairs):
        name = f"frame.source_views[{index}]"
        if not isinstance(pair, tuple) or len(pair) != 2 or getattr(pair[0], "_what", "") != "view":
            raise InvalidArgumentError(f"{name}: expected a pair of a View and its GBuffer, got {pair!r}")
        sources[index].view = pair[0].handle
        sources[index].gbuffer = gbuffer_struct(pair[1], kept, f"{name}.gbuffer")
    return sources, len(pairs)


def frame_struct(frame: Frame, kept: Kept) -> Any:
    instance(frame, Frame, "frame")
    struct = new_struct("LWFrame", kept)
    struct.reset, struct.frameIndex = int(bool(frame.reset)), whole(frame.index, "frame.index", high=2**64 - 1)
    lights = kept.add(ffi.new("LWLight[]", len(sequence(frame.lights, "frame.lights", "Light"))))
    for index, light in enumerate(frame.lights):
        _fill_light(lights[index], light, f"frame.lights[{index}]", kept)
    struct.lights, struct.lightCount = lights, len(frame.lights)
    struct.vpls, struct.vplCount = records_pointer(frame.vpls, "LWVpl", VPL, "frame.vpls", kept)
    struct.staticVpls, struct.staticVplCount = records_pointer(frame.static_vpls, "LWStaticVpl", STATIC_VPL, "frame.static_vpls", kept)
    struct.blockers, struct.blockerCount = records_pointer(frame.blockers, "LWBlocker", BLOCKER, "frame.blockers", kept)
    struct.sourceViews, struct.sourceViewCount = _sources(frame, kept)
    if frame.geometry is not None:
        struct.geometry = _geometry_struct(frame.geometry, kept)
    fill_vector(struct.environment, frame.environment, "frame.environment")
    fill_vector(struct.worldOrigin, frame.world_origin, "frame.world_origin")
    if frame.focus is not None:
        struct.focus = kept.add(ffi.new("float[3]"))
        fill_vector(struct.focus, frame.focus, "frame.focus")
    return struct
