"""Techniques' settings: keyword arguments checked against what the library says of itself (lwDescribeTechnique)."""
from __future__ import annotations

import dataclasses
import difflib
import functools
import math
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from ._enums import ParameterKind
from ._errors import InvalidArgumentError, check
from ._images import Kept
from ._library import NULL, ffi, lib, text

if TYPE_CHECKING:
    from ._technique import Technique

Setting = Union[bool, int, float, str, "Technique"]


@dataclasses.dataclass(frozen=True)
class Parameter:
    """One setting of a technique. `choices`: an enumeration's names, or the techniques that a tool may make for a part;
    `allowed`: the only values, where not all of the range are."""

    name: str
    description: str
    kind: ParameterKind
    minimum: float
    maximum: float
    default: Union[bool, int, float, str]
    choices: Tuple[str, ...]
    allowed: Tuple[float, ...]
    byte_offset: int


@dataclasses.dataclass(frozen=True)
class TechniqueInfo:
    name: str
    summary: str
    parameters: Mapping[str, Parameter]
    settings: Mapping[str, str]  # named sets of assignments, for Technique.from_text
    bounces: int  # 0: all of them
    points: bool  # render_points
    light_list: bool  # light_list
    desc_size: int
    set_defaults: Any


def _parameter(struct: Any) -> Parameter:
    kind = ParameterKind(struct.kind)
    choices: List[str] = []
    if struct.choices != NULL:
        while struct.choices[len(choices)] != NULL:
            choices.append(text(struct.choices[len(choices)]))
    default: Union[bool, int, float, str] = struct.defaultValue
    if kind in (ParameterKind.ENUM, ParameterKind.TECHNIQUE):
        default = choices[int(struct.defaultValue)]
    elif kind == ParameterKind.BOOL:
        default = bool(struct.defaultValue)
    elif kind == ParameterKind.UINT:
        default = int(struct.defaultValue)
    return Parameter(text(struct.name), text(struct.description), kind, struct.minimum, struct.maximum, default, tuple(choices),
                     tuple(struct.allowed[i] for i in range(struct.allowedCount)), struct.byteOffset)


def _describe(index: int) -> TechniqueInfo:
    struct = ffi.new("LWTechniqueInfo*")
    struct.structSize = ffi.sizeof("LWTechniqueInfo")
    check(lib.lwDescribeTechnique(index, struct))
    parameters = [_parameter(struct.parameters[i]) for i in range(struct.parameterCount)]
    named = {text(struct.settings[i].name): text(struct.settings[i].assignments) for i in range(struct.settingCount)}
    return TechniqueInfo(text(struct.name), text(struct.summary), {p.name: p for p in parameters}, named, struct.bounces,
                         bool(struct.points), bool(struct.lightList), struct.descSize, struct.setDefaults)


@functools.lru_cache(maxsize=None)
def _techniques() -> Dict[str, TechniqueInfo]:
    infos = [_describe(index) for index in range(lib.lwCountTechniques())]
    return {info.name: info for info in infos}


def describe_techniques() -> Dict[str, TechniqueInfo]:
    """All techniques by name, with their settings: meaning, range, default."""
    return dict(_techniques())


def technique_info(name: str) -> TechniqueInfo:
    if not isinstance(name, str) or name not in _techniques():
        raise InvalidArgumentError(f"technique: expected one of {', '.join(_techniques())}, got {name!r}")
    return _techniques()[name]


def _refuse(parameter: Parameter, expected: str, value: Any) -> InvalidArgumentError:
    return InvalidArgumentError(f"{parameter.name}: expected {expected}, got {value!r}")


def _number(parameter: Parameter, value: Any) -> float:
    whole = parameter.kind == ParameterKind.UINT
    expected = f"{'a whole number' if whole else 'a number'}, {parameter.minimum:.10g} .. {parameter.maximum:.10g}"
    if parameter.allowed:
        expected = "one of " + ", ".join(f"{each:.10g}" for each in parameter.allowed)
    if isinstance(value, (bool, np.bool_, str, bytes)) or np.ndim(value):
        raise _refuse(parameter, expected, value)
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise _refuse(parameter, expected, value) from None
    in_range = parameter.minimum <= number <= parameter.maximum and (not whole or number == math.floor(number))
    # The library takes a 0 that is out of range for the default; here a default is had by leaving the setting out.
    if not in_range or (parameter.allowed and number not in parameter.allowed):
        raise _refuse(parameter, expected, value)
    return number


def _choice(parameter: Parameter, value: Any) -> int:
    if isinstance(value, str) and value in parameter.choices:
        return parameter.choices.index(value)
    if isinstance(value, (bool, np.bool_)):
        # A switch with more than two positions.
        if {"on", "off"} <= set(parameter.choices):
            return parameter.choices.index("on" if value else "off")
    elif isinstance(value, (int, np.integer)) and 0 <= value < len(parameter.choices):
        return int(value)
    raise _refuse(parameter, "one of " + ", ".join(parameter.choices), value)


def _assign(at: Any, parameter: Parameter, value: Any, kept: Kept) -> None:
    if parameter.kind == ParameterKind.TECHNIQUE:
        if getattr(value, "_what", "") != "technique":
            raise _refuse(parameter, "a Technique", value)
        ffi.cast("LWTechnique*", at)[0] = kept.add(value).handle
    elif parameter.kind == ParameterKind.ENUM:
        ffi.cast("int32_t*", at)[0] = _choice(parameter, value)
    elif parameter.kind == ParameterKind.BOOL:
        if not isinstance(value, (bool, np.bool_)) and not (isinstance(value, (int, np.integer)) and value in (0, 1)):
            raise _refuse(parameter, "True or False", value)
        ffi.cast("uint32_t*", at)[0] = int(value)
    elif parameter.kind == ParameterKind.UINT:
        ffi.cast("uint32_t*", at)[0] = int(_number(parameter, value))
    else:
        ffi.cast("float*", at)[0] = _number(parameter, value)


def descriptor(name: str, settings: Mapping[str, Any], kept: Kept) -> Any:
    """The technique's descriptor with its defaults and these settings."""
    info = technique_info(name)
    memory = kept.add(ffi.new("uint64_t[]", (info.desc_size + 7) // 8))  # whole words: aligned for any field
    info.set_defaults(memory)
    for key, value in settings.items():
        parameter: Optional[Parameter] = info.parameters.get(key)
        if parameter is None:
            near = difflib.get_close_matches(key, info.parameters, 1)
            hint = f" (meant: {near[0]}?)" if near else ""
            raise InvalidArgumentError(f"{name}: expected settings among {', '.join(info.parameters)}, got {key!r}{hint}")
        _assign(ffi.cast("char*", memory) + parameter.byte_offset, parameter, value, kept)
    return memory
