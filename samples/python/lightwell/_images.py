"""NumPy arrays as the library's views of pixels: without a copy wherever LWImage can say what the array's strides say.

A format follows from type and shape: float32 (h, w), (h, w, 2 | 3 | 4), float16 (h, w, 4), uint8 (h, w, 4), int16
(h, w, 2: octahedral), uint8 or bool (h, w). `Image` overrules it and names an OpenCL buffer instead of an array.
"""
from __future__ import annotations

import dataclasses
import math
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from ._enums import Format
from ._errors import InvalidArgumentError
from ._library import ffi

Array = NDArray[Any]


@dataclasses.dataclass(frozen=True, eq=False)
class Image:
    """Pixels with their format said: `Image(albedo, Format.UNORM8X4_SRGB)`, or a `cl_mem` of the device's context by its address.

    `width`, `height`, `byte_offset` and the strides are for `cl_mem` alone; an array brings its own."""

    array: Optional[Array] = None
    format: Optional[Format] = None
    cl_mem: int = 0
    width: int = 0
    height: int = 0
    byte_offset: int = 0
    byte_pixel_stride: int = 0
    byte_row_stride: int = 0
    byte_plane_stride: int = 0


ImageLike = Union[Array, Image]

# By scalar type and channels (0: an array without a third axis).
_FORMATS: Dict[Tuple[str, int], Format] = {
    ("f4", 0): Format.FLOAT1, ("f4", 1): Format.FLOAT1, ("f4", 2): Format.FLOAT2, ("f4", 3): Format.FLOAT3,
    ("f4", 4): Format.FLOAT4, ("f2", 4): Format.HALF4, ("u1", 4): Format.UNORM8X4, ("i2", 2): Format.OCT16X2,
    ("u1", 0): Format.UINT8, ("b1", 0): Format.UINT8, ("u1", 1): Format.UINT8, ("b1", 1): Format.UINT8,
}
_EXPECTED = ("float32 (h, w), (h, w, 2), (h, w, 3) or (h, w, 4), float16 (h, w, 4), uint8 (h, w) or (h, w, 4), "
             "int16 (h, w, 2), bool (h, w)")
_SAME_MEMORY = {Format.UNORM8X4_SRGB: Format.UNORM8X4}  # formats that no array can tell apart
_PLANAR = {Format.FLOAT2: Format.PLANAR_FLOAT2, Format.FLOAT3: Format.PLANAR_FLOAT3}


def describe(array: Array) -> str:
    return f"{array.dtype} {array.shape}"


def plain_array(array: Any, name: str) -> Array:
    """An array whose memory is all there is to it; a masked one's mask would be passed over."""
    if not isinstance(array, np.ndarray) or isinstance(array, np.ma.MaskedArray):
        raise InvalidArgumentError(f"{name}: expected a NumPy array, got {type(array).__name__}")
    return array


def _format_of(array: Array, name: str) -> Format:
    if array.ndim not in (2, 3):
        raise InvalidArgumentError(f"{name}: expected {_EXPECTED}, got {describe(array)}")
    key = (array.dtype.str[1:], array.shape[2] if array.ndim == 3 else 0)
    if key not in _FORMATS or (array.dtype.itemsize > 1 and not array.dtype.isnative):
        raise InvalidArgumentError(f"{name}: expected {_EXPECTED}, got {describe(array)}")
    return _FORMATS[key]


def _strides(array: Array) -> List[int]:
    """Bytes from row to row, pixel to pixel, channel to channel; along an axis of one element, what is packed."""
    size = array.dtype.itemsize
    height, width = array.shape[:2]
    channels = array.shape[2] if array.ndim == 3 else 1
    channel = array.strides[2] if channels > 1 else size
    pixel = array.strides[1] if width > 1 else (size * channels if channel == size else size)
    row = array.strides[0] if height > 1 else width * pixel
    return [row, pixel, channel]


def _layout(array: Array, format: Format) -> Optional[Tuple[Format, int, int, int]]:
    """Format, row, pixel and plane stride by which LWImage names the array's memory; None where it cannot."""
    if not array.flags.aligned:
        return None
    height, width = array.shape[:2]
    row, pixel, channel = _strides(array)
    size = array.dtype.itemsize
    channels = array.shape[2] if array.ndim == 3 else 1
    if channel == size:
        pixel_bytes, planar = size * channels, False
    elif format in _PLANAR:
        pixel_bytes, planar = size, True
    else:
        return None
    row_bytes = (width - 1) * pixel + pixel_bytes
    if pixel < pixel_bytes or (height > 1 and abs(row) < row_bytes):
        return None  # mirrored columns, transposed or repeated pixels
    if not planar:
        return format, row, pixel, 0
    side_by_side = channel >= row_bytes and (channels - 1) * channel + row_bytes <= abs(row)
    if not side_by_side and channel < (height - 1) * abs(row) + row_bytes:
        return None
    return _PLANAR[format], row, pixel, channel


@dataclasses.dataclass
class Kept:
    """What one call's arguments rest on, alive until the device has finished with it; `copied`: bytes of arrays whose
    layout no LWImage can name."""

    objects: List[Any] = dataclasses.field(default_factory=list)
    copied: int = 0

    def add(self, thing: Any) -> Any:
        self.objects.append(thing)
        return thing


def _fill_cl(target: Any, image: Image, name: str) -> None:
    if image.format is None or image.width < 1 or image.height < 1:
        raise InvalidArgumentError(f"{name}: expected format, width and height beside cl_mem, got "
                                   f"{image.format}, {image.width}, {image.height}")
    target.clMem = ffi.cast("void*", image.cl_mem)
    target.format, target.width, target.height = int(image.format), image.width, image.height
    target.byteOffset = image.byte_offset
    target.bytePixelStride, target.byteRowStride = image.byte_pixel_stride, image.byte_row_stride
    target.bytePlaneStride = image.byte_plane_stride


def _stated_format(image: Image, format: Format, name: str) -> Format:
    stated = image.format
    if stated is None or stated == format:
        return format
    if _SAME_MEMORY.get(stated) != format and _PLANAR.get(format) != stated:
        raise InvalidArgumentError(f"{name}: expected an array of format {stated.name}, got one of {format.name}")
    return stated if stated in _SAME_MEMORY else format


def fill_image(target: Any, source: Optional[ImageLike], name: str, kept: Kept, written: bool = False) -> None:
    """Fills an LWImage from an array, an `Image` or nothing. An input that LWImage cannot name is copied; an output
    (`written`) is refused."""
    if source is None:
        return
    image = source if isinstance(source, Image) else Image(source)
    if image.array is None:
        if not image.cl_mem:
            raise InvalidArgumentError(f"{name}: expected an array or cl_mem, got neither")
        _fill_cl(target, image, name)
        return
    array = plain_array(image.array, name)
    format = _stated_format(image, _format_of(array, name), name)
    if array.size == 0:
        raise InvalidArgumentError(f"{name}: expected an array of one pixel or more, got {describe(array)}")
    if written and not array.flags.writeable:
        raise InvalidArgumentError(f"{name}: expected an array that may be written, got a read-only one")
    layout = _layout(array, format)
    if layout is None and not written:
        array = np.array(array, order="C", copy=True)
        kept.copied += array.nbytes
        layout = _layout(array, format)
    if layout is None:
        raise InvalidArgumentError(f"{name}: expected an array of pixels from left to right, with strides that LWImage can "
                                   f"name, got {describe(array)} with strides {array.strides}")
    kept.add(array)
    in_format, row, pixel, plane = layout
    height, width = array.shape[:2]
    below = row * (height - 1) if row < 0 else 0  # bytes from pixel (0, 0) back to where the memory starts
    target.host = ffi.cast("void*", array.ctypes.data + below)
    target.format, target.width, target.height = int(in_format), width, height
    target.byteOffset, target.bytePixelStride = -below, pixel
    target.byteRowStride, target.bytePlaneStride = row, plane


def empty_image(height: int, width: int, channels: int = 1) -> NDArray[np.float32]:
    """A float32 image that Lightwell uses in place: planes whose rows are whole groups of 16 pixels on 64-byte borders. Seen as
    (height, width, channels), or (height, width) for one channel. Its pixels are not set."""
    if height < 1 or width < 1 or channels not in (1, 2, 3):
        raise InvalidArgumentError(f"empty_image: expected a size of 1 or more and 1, 2 or 3 channels, got {height}, {width}, {channels}")
    padded = math.ceil(width / 16) * 16
    memory = np.empty(channels * height * padded * 4 + 64, np.uint8)
    start = -memory.ctypes.data % 64
    planes = memory[start:start + channels * height * padded * 4].view(np.float32).reshape(channels, height, padded)
    seen = planes[:, :, :width].transpose(1, 2, 0)
    return seen[:, :, 0] if channels == 1 else seen
