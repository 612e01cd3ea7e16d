"""Devices: the OpenCL device with its queue and its cache of compiled kernels."""
from __future__ import annotations

import dataclasses
import os
import traceback
from typing import Any, Callable, List, Optional, Union

from ._arguments import whole, words
from ._enums import LogLevel
from ._errors import check
from ._frame import Frame, frame_struct, new_struct
from ._handles import Handle, InFlight, finish_and_release, release_deferred
from ._images import Kept
from ._library import ffi, lib, text
from ._settings import Setting, descriptor
from ._technique import Technique
from ._view import View

Log = Callable[[LogLevel, str], None]


@dataclasses.dataclass(frozen=True)
class DeviceInfo:
    """Of a device that was not created, `width`, memory held and the counters are 0."""

    name: str
    platform: str
    driver: str
    opencl_version: str
    compute_units: int
    width: int
    is_gpu: bool
    host_unified_memory: bool
    has_profiling: bool
    global_memory_bytes: int
    max_allocation_bytes: int
    allocated_bytes: int
    programs_built: int
    programs_loaded: int
    kernels_specialised: int


@dataclasses.dataclass(frozen=True)
class Roofline:
    """Measured rates: 10^9 operations and bytes per second, microseconds a launch."""

    width: int
    multiply_add_gflops: float
    bandwidth_gb_per_s: float
    launch_microseconds: float


def _info(struct: Any) -> DeviceInfo:
    return DeviceInfo(
        name=text(struct.name), platform=text(struct.platform), driver=text(struct.driver), opencl_version=text(struct.openclVersion),
        compute_units=struct.computeUnits, width=struct.width, is_gpu=bool(struct.isGpu),
        host_unified_memory=bool(struct.hostUnifiedMemory), has_profiling=bool(struct.hasProfiling),
        global_memory_bytes=struct.globalMemoryBytes, max_allocation_bytes=struct.maxAllocationBytes,
        allocated_bytes=struct.allocatedBytes, programs_built=struct.programsBuilt, programs_loaded=struct.programsLoaded,
        kernels_specialised=struct.kernelsSpecialised)


def devices() -> List[DeviceInfo]:
    """The OpenCL devices of this machine; `Device("0:1")` names platform and device, `Device(info.name)` a device by name."""
    count = ffi.new("uint32_t*")
    check(lib.lwCountDevices(count))
    found = []
    for index in range(count[0]):
        struct = new_struct("LWDeviceInfo")
        check(lib.lwDescribeDevice(index, struct))
        found.append(_info(struct))
    return found


def _log_callback(log: Log) -> Any:
    def called(user: Any, level: int, message: Any) -> None:
        log(LogLevel(level), text(message))

    def failed(kind: Any, error: Any, trace: Any) -> None:
        traceback.print_exception(kind, error, trace)  # it must not cross the library's frames

    return ffi.callback("LWLogCallback", called, onerror=failed)


class Device(Handle):
    """An OpenCL device. `selector`: "gpu", "cpu", "PLATFORM:DEVICE" or a part of a name; None: LIGHTWELL_DEVICE, else the best.

    Calls may come from any thread and let other Python threads run; the device takes them one after the other."""

    _what = "device"

    def __init__(self, selector: Optional[str] = None, *, width: int = 0, max_compute_units: int = 0, profiling: bool = True,
                 cache_directory: "Union[str, os.PathLike[str], None]" = None, log: Optional[Log] = None) -> None:
        """`width`: lanes per work-item, 0: by probe. `cache_directory`: of compiled kernels; "": none. `log` is called as
        log(level, message) and must not call Lightwell; without it warnings and errors go to stderr."""
        release_deferred()
        desc = new_struct("LWDeviceDesc")
        lib.lwDefaultDevice(desc)
        kept = []
        directory = None if cache_directory is None else os.fspath(cache_directory)
        for name, field, value in (("selector", "selector", selector), ("cache_directory", "cacheDirectory", directory)):
            if value is not None:
                kept.append(ffi.new("char[]", words(value, name)))
                setattr(desc, field, kept[-1])
        desc.width, desc.maxComputeUnits = whole(width, "width"), whole(max_compute_units, "max_compute_units")
        desc.noProfiling = int(not profiling)
        callback = _log_callback(log) if log is not None else None
        if callback is not None:
            desc.log = callback
        handle = ffi.new("LWDevice*")
        check(lib.lwCreateDevice(desc, handle))
        self._in_flight = InFlight()
        self.copied_bytes = 0
        self.log_callback = callback  # views and techniques keep it too: the C device lives, and logs, as long as they do
        super().__init__(handle[0], finish_and_release(self._in_flight), callback)

    @property
    def info(self) -> DeviceInfo:
        struct = new_struct("LWDeviceInfo")
        check(lib.lwGetDeviceInfo(self.handle, struct), self.handle)
        return _info(struct)

    def probe(self) -> Roofline:
        """Measures the device's rates, for less than two seconds; `View.plan` knows them from then on."""
        struct = new_struct("LWRoofline")
        check(lib.lwProbeDevice(self.handle, struct), self.handle)
        return Roofline(struct.width, struct.multiplyAddGflops, struct.bandwidthGBps, struct.launchMicroseconds)

    def finish(self) -> None:
        """Waits for all that was enqueued; outputs then hold their pixels, and inputs are free."""
        handle = self.handle
        taken = self._in_flight.take()
        status = lib.lwFinish(handle)
        if status == lib.LW_ERROR_REENTRANT:  # nothing was waited for
            self._in_flight.keep(taken)
        del taken
        check(status, handle)
        release_deferred()

    def view(self, width: int, height: int) -> View:
        """A viewport of that size, at most."""
        return View(self, width, height)

    def technique(self, name: str, **settings: Setting) -> Technique:
        """A technique by name, `describe_techniques()` lists them, with settings other than its defaults."""
        return Technique(self, name, **settings)

    def technique_from_text(self, name: str, settings: str = "") -> Technique:
        """A technique by settings as a Plan has them: "vpls=256 interleave=4"."""
        return Technique.from_text(self, name, settings)

    def estimate_memory(self, name: str, width: int, height: int, *, rsm_texels: int = 512 * 512, frame: Optional[Frame] = None,
                        **settings: Setting) -> int:
        """Device bytes that a technique would hold for a view of this size and one RSM of `rsm_texels`, or for `frame`'s own."""
        kept = Kept()
        desc = descriptor(name, settings, kept)
        view = new_struct("LWViewDesc", kept)
        view.maxWidth, view.maxHeight = whole(width, "width"), whole(height, "height")
        size = ffi.new("uint64_t*")
        if frame is None:
            check(lib.lwEstimateMemory(self.handle, name.encode(), desc, view, whole(rsm_texels, "rsm_texels", high=2**64 - 1), size), self.handle)
        else:
            struct = frame_struct(frame, kept)
            check(lib.lwEstimateFrameMemory(self.handle, name.encode(), desc, view, struct, size), self.handle)
        return int(size[0])

    def keep(self, kept: Kept) -> None:
        """Keeps what a call has enqueued, until `finish`."""
        self.copied_bytes += kept.copied
        self._in_flight.keep(kept)
