"""The header's enumerations that arguments and results use; tests/python checks their names and values against it.

Enumerations of techniques' settings are not here: settings take the names that `describe_techniques()` lists.
"""
from __future__ import annotations

import enum


class Status(enum.IntEnum):
    SUCCESS = 0
    INVALID_ARGUMENT = 1
    INVALID_HANDLE = 2
    OUT_OF_MEMORY = 3
    UNSUPPORTED = 4
    NO_DEVICE = 5
    BUILD_FAILED = 6
    DEVICE = 7
    NOT_UPDATED = 8
    REENTRANT = 9
    INTERNAL = 10


class LogLevel(enum.IntEnum):
    INFO = 0
    WARNING = 1
    ERROR = 2


class Format(enum.IntEnum):
    """How an image's memory is read. Mostly told from the array's type and shape (docs/python.md)."""

    NONE = 0
    FLOAT1 = 1
    FLOAT2 = 2
    FLOAT3 = 3
    FLOAT4 = 4
    HALF4 = 5
    UNORM8X4 = 6
    UNORM8X4_SRGB = 7
    OCT16X2 = 8
    PLANAR_FLOAT2 = 9
    PLANAR_FLOAT3 = 10
    UINT8 = 11


class DepthKind(enum.IntEnum):
    ZERO_TO_ONE = 0
    GL = 1
    AXIAL = 2
    RADIAL = 3


class LightKind(enum.IntEnum):
    DIRECTIONAL = 0
    POINT = 1
    SPOT = 2


class Receivers(enum.IntFlag):
    """Who gets a light's or a VPL's indirect light in technique "static_vpl"."""

    ALL = 0
    UNBAKED = 1
    BAKED = 2


class ParameterKind(enum.IntEnum):
    UINT = 0
    FLOAT = 1
    ENUM = 2
    BOOL = 3
    TECHNIQUE = 4


class Severity(enum.IntEnum):
    NOTE = 0
    WARNING = 1
    ERROR = 2


class InputFault(enum.IntEnum):
    """What can be wrong with inputs; docs/checking-inputs.md says how each is found."""

    NOT_FINITE = 0
    NEGATIVE = 1
    NO_SURFACES = 2
    NORMAL_MISSING = 3
    NORMAL_LENGTH = 4
    NORMAL_ENCODED = 5
    NORMAL_SPACE = 6
    NORMAL_FLIPPED = 7
    NORMAL_DISAGREES = 8
    CAMERA_INVALID = 9
    CAMERA_TRANSPOSED = 10
    CAMERA_PREVIOUS = 11
    IMAGE_FLIPPED = 12
    POSITION_SPACE = 13
    POSITION_UNITS = 14
    POSITION_CAMERA = 15
    DEPTH_REVERSED = 16
    DEPTH_KIND = 17
    MOTION_SIGN = 18
    MOTION_FLIPPED_Y = 19
    MOTION_UNITS = 20
    MOTION_ZERO = 21
    MOTION_STATIC = 22
    MOTION_DISAGREES = 23
    ALBEDO_RANGE = 24
    ALBEDO_SRGB = 25
    DIRECT_SCALE = 26
    FLUX_PI = 27
    FLUX_TEXELS = 28
    FLUX_SCALE = 29
    RSM_EMPTY = 30
    RSM_ELSEWHERE = 31
    SPACES_DIFFER = 32
    UNITS_DIFFER = 33
    LIGHT_CAMERA = 34
    FAR_FROM_ORIGIN = 35
