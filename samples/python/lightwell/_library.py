"""Finds and opens the shared library; `lib` and `ffi` are what the other modules call it by.

The file is LIGHTWELL_LIBRARY where that is set, else the one beside this module (the wheel holds it), else what the
system's loader finds. A library of another version than the header's is refused: structs would not fit.
"""
from __future__ import annotations

import os
import pathlib
import sys
from typing import Any

try:
    from ._header import ABI as _ABI, ffi as _ffi  # written by bind_header.py when the package is built
except ImportError as error:  # the source folder is no package yet
    raise ImportError("lightwell: expected lightwell/_header.py, which the build writes beside the library: "
                      "`pip install .` in Lightwell's root, or the folder build/<preset>/python on PYTHONPATH"
                      f" ({error})") from error

ffi: Any = _ffi
_NAMES = {"darwin": f"liblightwell.{_ABI}.dylib", "win32": "lightwell.dll"}
FILE_NAME = _NAMES.get(sys.platform, f"liblightwell.so.{_ABI}")


def _path() -> str:
    chosen = os.environ.get("LIGHTWELL_LIBRARY")
    if chosen:
        return chosen
    beside = pathlib.Path(__file__).resolve().parent / FILE_NAME
    return str(beside) if beside.exists() else FILE_NAME


def _open() -> Any:
    path = _path()
    try:
        library = ffi.dlopen(path)
    except OSError as error:
        raise ImportError(f"lightwell: cannot open {path}: {error}. An OpenCL loader (Debian: ocl-icd-libopencl1) must "
                          "be installed; LIGHTWELL_LIBRARY names another file") from error
    try:
        library.lwVersion
    except (AttributeError, ffi.error) as error:
        raise ImportError(f"lightwell: expected Lightwell's library, got {path}: {error}") from error
    header = f"{library.LW_VERSION_MAJOR}.{library.LW_VERSION_MINOR}.{library.LW_VERSION_PATCH}"
    version = text(library.lwVersion())
    if version != header:
        raise ImportError(f"lightwell: expected a library of version {header}, got {version} from {path}")
    return library


def text(pointer: Any) -> str:
    """A C string, or "" where it is null."""
    return "" if pointer == ffi.NULL else ffi.string(pointer).decode("utf-8", "replace")


lib: Any = _open()
NULL: Any = ffi.NULL
__version__: str = text(lib.lwVersion())
