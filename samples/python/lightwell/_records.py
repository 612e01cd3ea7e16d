"""Arrays of the structs that keep their layout (VPLs, blockers, listed lights), as structured NumPy arrays."""
from __future__ import annotations

from typing import Any, Dict, List, Tuple

import numpy as np

from ._errors import InvalidArgumentError
from ._images import Array, Kept, describe
from ._library import ffi

_SCALARS = {"float": "f4", "uint32_t": "u4"}


def record_type(struct: str) -> "np.dtype[Any]":
    """The NumPy type of an LW struct of numbers, field for field where the header has them."""
    names: List[str] = []
    formats: List[Any] = []
    offsets: List[int] = []
    for name, field in ffi.typeof(struct).fields:
        names.append("".join("_" + c.lower() if c.isupper() else c for c in name))
        offsets.append(field.offset)
        length = field.type.length if field.type.kind == "array" else 1
        scalar = _SCALARS[(field.type.item if field.type.kind == "array" else field.type).cname]
        formats.append((scalar, (length,)) if field.type.kind == "array" else scalar)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(struct)})


VPL = record_type("LWVpl")
STATIC_VPL = record_type("LWStaticVpl")
BLOCKER = record_type("LWBlocker")
LISTED_LIGHT = record_type("LWListedLight")


def _make_records(dtype: "np.dtype[Any]", fields: Dict[str, Any]) -> Array:
    """One record for each row of the first field; the others may be one value for all."""
    try:
        first = np.asarray(next(iter(fields.values())))
    except ValueError as error:
        raise InvalidArgumentError(f"{next(iter(fields))}: expected (n, 3) numbers: {error}") from error
    if first.ndim != 2:
        raise InvalidArgumentError(f"{next(iter(fields))}: expected (n, 3) numbers, got shape {first.shape}")
    records = np.zeros(len(first), dtype)
    for name, value in fields.items():
        try:
            records[name] = value
        except (TypeError, ValueError, OverflowError) as error:
            raise InvalidArgumentError(f"{name}: expected {records[name].shape} numbers, or one for all: {error}") from error
    return records


def vpls(position: Any, normal: Any, flux: Any, area: Any = 0.0) -> Array:
    """Small Lambertian emitters: (n, 3) positions, unit normals and fluxes in W; areas in m^2, 0: points."""
    return _make_records(VPL, {"position": position, "normal": normal, "flux": flux,
                               "area": area})


def static_vpls(position: Any, normal: Any, reflectance: Any, weight: Any = 0.0, light_mask: Any = 0, receivers: Any = 0) -> Array:
    """Places that "static_vpl" turns into VPLs: (n, 3) positions, unit normals and reflectances."""
    return _make_records(STATIC_VPL, {
        "position": position, "normal": normal, "reflectance": reflectance,
        "weight": weight, "light_mask": light_mask, "receivers": receivers})


def blockers(center: Any, radius: Any) -> Array:
    """Spheres that dim light softly ("static_vpl"): (n, 3) centres and radii."""
    return _make_records(BLOCKER, {"center": center, "radius": radius})


def records_pointer(values: Any, struct: str, dtype: "np.dtype[Any]", name: str, kept: Kept) -> Tuple[Any, int]:
    if values is None:
        return ffi.NULL, 0
    if not isinstance(values, np.ndarray) or values.dtype != dtype or values.ndim != 1:
        got = describe(values) if isinstance(values, np.ndarray) else type(values).__name__
        raise InvalidArgumentError(f"{name}: expected a one-dimensional array of lightwell.{name.split('.')[-1]}(), got {got}")
    if not values.flags.c_contiguous or not values.flags.aligned:
        values = np.array(values, order="C", copy=True)
        kept.copied += values.nbytes
    kept.add(values)
    return ffi.cast(struct + "*", values.ctypes.data), len(values)
