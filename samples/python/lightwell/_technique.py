"""Techniques: updated once per frame, rendered once per view."""
from __future__ import annotations

import dataclasses
import threading
import weakref
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Union

import numpy as np
from numpy.typing import NDArray

from ._arguments import instance, words
from ._errors import InvalidArgumentError, check
from ._frame import Frame, GBuffer, frame_struct, gbuffer_struct, new_struct
from ._handles import Handle
from ._images import Array, Image, Kept, describe, empty_image, fill_image, plain_array
from ._library import NULL, ffi, lib, text
from ._records import LISTED_LIGHT
from ._settings import Setting, descriptor, technique_info
from ._view import View

if TYPE_CHECKING:
    from ._device import Device

Wanted = Union[bool, Array, Image]


@dataclasses.dataclass(frozen=True, eq=False)
class Output:
    """What `render` made: colours (height, width, 3), others (height, width), float32; None where not asked for."""

    irradiance: Optional[Any] = None
    validity: Optional[Any] = None
    ambient_occlusion: Optional[Any] = None
    specular_radiance: Optional[Any] = None
    shadow: Optional[Any] = None
    refracted_radiance: Optional[Any] = None


@dataclasses.dataclass(frozen=True, eq=False)
class PointOutput:
    """What `render_points` made: irradiance (n, 3), harmonics (4, n, 3), validity (n,); None where not asked for."""

    irradiance: Optional[Array] = None
    harmonics: Optional[Array] = None
    validity: Optional[Array] = None


@dataclasses.dataclass(frozen=True)
class DebugView:
    """An intermediate buffer of the last frame; `description` has the unit of each channel."""

    name: str
    description: str
    width: int
    height: int
    channels: int


class Technique(Handle):
    """A method with its settings and its picture of the light in the world. Parts of a technique that joins others are given as
    settings: `Technique(device, "fallback", first=near, second=far)`."""

    _what = "technique"

    def __init__(self, device: "Device", name: str, **settings: Setting) -> None:
        kept = Kept()
        desc = descriptor(name, settings, kept)
        handle = ffi.new("LWTechnique*")
        check(lib.lwCreateTechnique(device.handle, name.encode(), desc, handle), device.handle)
        self._begin(device, name, handle[0], kept)

    @classmethod
    def from_text(cls, device: "Device", name: str, settings: str = "") -> "Technique":
        """By assignments as a Plan and the command line have them: "first=horizon second=ssvp second.vpls=256"."""
        technique_info(name)
        handle = ffi.new("LWTechnique*")
        check(lib.lwCreateTechniqueFromText(device.handle, name.encode(), words(settings, "settings"), handle), device.handle)
        made = cls.__new__(cls)
        made._begin(device, name, handle[0], Kept())
        return made

    def _begin(self, device: "Device", name: str, handle: Any, parts: Kept) -> None:
        self.device, self.name = device, name
        self._parts = parts
        self._lock = threading.Lock()
        # What debug views look into: memory that the last update (by this technique) and the last render (by its view) used in place.
        self._last: "weakref.WeakKeyDictionary[Handle, Kept]" = weakref.WeakKeyDictionary()
        super().__init__(handle, lib.lwReleaseTechnique, device.log_callback)

    def _call(self, function: Any, whose: Optional[Handle], kept: Kept, *arguments: Any) -> None:
        """One call that enqueues; what it rests on is kept, also where it failed half-way."""
        device = self.device.handle
        try:
            check(function(self.handle, *arguments), device)
        finally:
            self.device.keep(kept)
            if whose is not None:
                self._last[whose] = kept

    def prewarm(self, view: View) -> None:
        """Compiles all kernels that frames of this view can need."""
        check(lib.lwPrewarm(self.handle, instance(view, View, "view").handle), self.device.handle)

    def update(self, frame: Frame) -> None:
        """The world part, once per frame. Its arrays must not be changed before `Device.finish` or a `render` that waits."""
        kept = Kept()
        self._call(lib.lwUpdate, self, kept, frame_struct(frame, kept))

    def render(self, view: View, gbuffer: GBuffer, *, irradiance: Wanted = True, validity: Wanted = False,
               ambient_occlusion: Wanted = False, specular_radiance: Wanted = False, shadow: Wanted = False,
               refracted_radiance: Wanted = False, wait: bool = True) -> Output:
        """One view's indirect light. True: a new array; an array: written into; False: not made. With `wait=False` the pixels are
        there after `Device.finish`."""
        kept = Kept()
        wanted = dict(irradiance=irradiance, validity=validity, ambientOcclusion=ambient_occlusion, specularRadiance=specular_radiance,
                      shadow=shadow, refractedRadiance=refracted_radiance)
        struct = new_struct("LWOutput", kept)
        width, height = instance(view, View, "view").size
        made = {name: _target(getattr(struct, name), want, height, width, name, kept) for name, want in wanted.items()}
        given = Kept()
        inputs = gbuffer_struct(gbuffer, given)
        _check_memory(made, given)
        kept.objects += given.objects
        kept.copied += given.copied
        self._call(lib.lwRender, view, kept, view.handle, inputs, struct)
        if wait:
            self.device.finish()
        return Output(made["irradiance"], made["validity"], made["ambientOcclusion"], made["specularRadiance"], made["shadow"],
                      made["refractedRadiance"])

    def render_points(self, positions: Array, normals: Optional[Array] = None, *, irradiance: bool = True, harmonics: bool = False,
                      validity: bool = False, baked: bool = False, wait: bool = True) -> PointOutput:
        """The light at (n, 3) positions: irradiance of their normals, and two bands of spherical harmonics of what arrives, from all
        around. `describe_techniques()[name].points` says who can."""
        kept = Kept()
        count = len(plain_array(positions, "positions")) if np.ndim(positions) else 0
        images = []
        for name, points in (("positions", positions), ("normals", normals)):
            if points is None:
                images.append(NULL)
                continue
            if plain_array(points, name).ndim != 2 or len(points) != count:
                raise InvalidArgumentError(f"{name}: expected ({count}, 3) float32, got {describe(points)}")
            images.append(kept.add(ffi.new("LWImage*")))
            fill_image(images[-1], points[np.newaxis], name, kept)
        struct = new_struct("LWPointOutput", kept)
        struct.baked = int(baked)
        made = [_target(getattr(struct, name), want, rows, count, name, kept, channels)
                for name, want, rows, channels in (("irradiance", irradiance, 1, 3), ("harmonics", harmonics, 4, 3), ("validity", validity, 1, 1))]
        self._call(lib.lwRenderPoints, None, kept, images[0], images[1], count, struct)
        if wait:
            self.device.finish()
        return PointOutput(None if made[0] is None else made[0][0], made[1], None if made[2] is None else made[2][0])

    def light_list(self) -> Array:
        """The last update's light as a few lights, for renderers that light with their own shaders: a structured array. Waits."""
        desc = technique_info(self.name)
        capacity = int(desc.parameters["lights"].maximum) if "lights" in desc.parameters else 1
        lights, count = np.zeros(capacity, LISTED_LIGHT), ffi.new("uint32_t*")
        pointer = ffi.cast("LWListedLight*", lights.ctypes.data)
        check(lib.lwReadLightList(self.handle, pointer, capacity, count), self.device.handle)
        return lights[:count[0]].copy()

    def stats(self) -> Dict[str, Any]:
        """The last frame's report: `passes` {name: {"ms", "launches"}}, `counts` {name: number}, `choices` [(name, reason)],
        `total_ms` (None: unavailable), `frame_index`, `device_bytes`, `host_copy_bytes`. Waits."""
        device = self.device.handle
        struct = new_struct("LWStats")
        with self._lock:  # its arrays are valid until the next call on this technique
            check(lib.lwGetStats(self.handle, struct), device)
            passes = {text(p.name): {"ms": _ms(p.milliseconds), "launches": p.launches}
                      for p in (struct.passes[i] for i in range(struct.passCount))}
            counts = {text(c.name): c.value for c in (struct.counts[i] for i in range(struct.countCount))}
            choices = [(text(c.name), text(c.reason)) for c in (struct.choices[i] for i in range(struct.choiceCount))]
        return {"frame_index": struct.frameIndex, "total_ms": _ms(struct.totalMilliseconds), "passes": passes, "counts": counts,
                "choices": choices, "device_bytes": struct.deviceBytes, "host_copy_bytes": struct.hostCopyBytes}

    def debug_views(self, view: Optional[View] = None) -> List[DebugView]:
        """The intermediate buffers of the last frame; without a view those of the world part."""
        device, handle = self.device.handle, view.handle if view is not None else NULL
        count = ffi.new("uint32_t*")
        check(lib.lwCountDebugViews(self.handle, handle, count), device)
        views = []
        for index in range(count[0]):
            struct = new_struct("LWDebugView")
            check(lib.lwDescribeDebugView(self.handle, handle, index, struct), device)
            views.append(DebugView(text(struct.name), text(struct.description), struct.width, struct.height, struct.channels))
        return views

    def debug_view(self, name: str, view: Optional[View] = None) -> NDArray[np.float32]:
        """One of them as (height, width, channels). Waits."""
        found = [each for each in self.debug_views(view) if each.name == name]
        if not found:
            names = ", ".join(each.name for each in self.debug_views(view))
            raise InvalidArgumentError(f"name: expected one of {names}, got {name!r}")
        info = found[0]
        planes = np.empty((info.channels, info.height, info.width), np.float32)
        check(lib.lwReadDebugView(self.handle, view.handle if view is not None else NULL, name.encode(),
                                  ffi.cast("float*", planes.ctypes.data), planes.size), self.device.handle)
        return planes.transpose(1, 2, 0)


def _ms(milliseconds: float) -> Optional[float]:
    return None if milliseconds < 0.0 else milliseconds


_MAX_WORK: Any = 10000  # steps of its search: microseconds


def _share(one: Array, other: Array) -> bool:
    if not np.may_share_memory(one, other):
        return False
    try:
        return bool(np.shares_memory(one, other, max_work=_MAX_WORK))
    except RuntimeError:  # NumPy's TooHardError: strides for which it is not soon said
        return False


def _check_memory(made: Dict[str, Any], given: Kept) -> None:
    """Refuses outputs that share memory with each other or with an input, which the device reads while it writes."""
    arrays = [(name, each.array if isinstance(each, Image) else each) for name, each in made.items()]
    outputs = [(name, each) for name, each in arrays if each is not None]
    inputs = [each for each in given.objects if isinstance(each, np.ndarray)]
    for index, (name, output) in enumerate(outputs):
        shared = [f"output.{other}" for other, array in outputs[:index] if _share(output, array)]
        shared += ["an input" for array in inputs if _share(output, array)]
        if shared:
            raise InvalidArgumentError(f"output.{name}: expected memory of its own, got some of {shared[0]}")


_COLOURS = ("irradiance", "specularRadiance", "refractedRadiance")


def _target(image: Any, want: Wanted, height: int, width: int, name: str, kept: Kept, channels: int = 0) -> Any:
    """Where one output goes: a new array, the caller's, or nowhere."""
    if isinstance(want, (bool, np.bool_)):
        want = bool(want)
    if want is False or want is None:
        return None
    target = empty_image(height, width, channels or (3 if name in _COLOURS else 1)) if want is True else want
    fill_image(image, target, f"output.{name}", kept, written=True)
    return target
