"""Arguments as the library's structs take them. What does not fit is refused by name, before C sees it."""
from __future__ import annotations

import enum
import operator
from typing import Any, Sequence, Tuple, Type, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._errors import InvalidArgumentError

Kind = TypeVar("Kind")
Choice = TypeVar("Choice", enum.IntEnum, enum.IntFlag)


def whole(value: Any, name: str, low: int = 0, high: int = 2**32 - 1) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        number = low - 1
    if not low <= number <= high:
        raise InvalidArgumentError(f"{name}: expected a whole number, {low} .. {high}, got {value!r}")
    return number


def real(value: Any, name: str) -> float:
    try:
        if not isinstance(value, (str, bytes)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InvalidArgumentError(f"{name}: expected a number, got {value!r}")


def numbers(values: Any, shape: Tuple[int, ...], name: str) -> NDArray[np.float64]:
    """Real numbers of that shape: complex ones, words and None are not turned into any."""
    wanted = "three numbers" if shape == (3,) else " x ".join(map(str, shape)) + " numbers"
    try:
        array = np.asarray(values).astype(np.float64, casting="same_kind")
    except (TypeError, ValueError) as error:
        raise InvalidArgumentError(f"{name}: expected {wanted}, got {values!r}") from error
    if array.shape != shape:
        raise InvalidArgumentError(f"{name}: expected {wanted}, got {values!r}")
    return array


def words(value: Any, name: str) -> bytes:
    """Text for C, which would end it at a NUL."""
    if not isinstance(value, str) or "\0" in value:
        raise InvalidArgumentError(f"{name}: expected a string without NUL, got {value!r}")
    return value.encode()


def instance(value: Any, kind: Type[Kind], name: str) -> Kind:
    if not isinstance(value, kind):
        raise InvalidArgumentError(f"{name}: expected {'an' if kind.__name__ == 'Rsm' else 'a'} {kind.__name__}, got {type(value).__name__}")
    return value


def sequence(values: Any, name: str, of: str) -> Sequence[Any]:
    if not isinstance(values, (list, tuple)):
        raise InvalidArgumentError(f"{name}: expected a list of {of}, got {type(values).__name__}")
    return values


def choice(kind: Type[Choice], value: Any, name: str) -> int:
    try:
        return int(kind(value))
    except (TypeError, ValueError):
        raise InvalidArgumentError(f"{name}: expected one of {', '.join(kind.__members__)}, got {value!r}") from None
