"""Exceptions: each carries the call's `status` and its `message`, which names the argument, what was expected and what came."""
from __future__ import annotations

from typing import Any, Dict, Type

from ._enums import Status
from ._library import NULL, ffi, lib, text


class Error(RuntimeError):
    """A call of Lightwell's that failed."""

    status: Status = Status.INTERNAL

    def __init__(self, message: str, status: "Status | None" = None) -> None:
        if status is not None:
            self.status = status
        self.message = message
        super().__init__(message)

    def __str__(self) -> str:
        return f"{text(lib.lwStatusName(int(self.status)))}: {self.message}"


class InvalidArgumentError(Error, ValueError):
    """A value, an array's type, shape or layout, or a setting that was refused."""

    status = Status.INVALID_ARGUMENT


class InvalidHandleError(Error):
    """A device, view or technique that is closed, or belongs to another device."""

    status = Status.INVALID_HANDLE


class OutOfMemoryError(Error, MemoryError):
    status = Status.OUT_OF_MEMORY


class UnsupportedError(Error):
    """The device, or the technique, lacks what was asked for."""

    status = Status.UNSUPPORTED


class NoDeviceError(Error):
    status = Status.NO_DEVICE


class BuildError(Error):
    """A kernel does not build; the message carries the compiler's log."""

    status = Status.BUILD_FAILED


class DeviceError(Error):
    """The OpenCL driver failed while executing."""

    status = Status.DEVICE


class NotUpdatedError(Error):
    """`render` before a successful `update`."""

    status = Status.NOT_UPDATED


class ReentrantError(Error):
    """A call from inside a log function."""

    status = Status.REENTRANT


_BY_STATUS: Dict[int, Type[Error]] = {int(kind.status): kind for kind in (
    InvalidArgumentError, InvalidHandleError, OutOfMemoryError, UnsupportedError, NoDeviceError, BuildError, DeviceError,
    NotUpdatedError, ReentrantError)}


def error_of(status: int, message: str) -> Error:
    return _BY_STATUS.get(status, Error)(message, Status(status))


def check(status: int, device: Any = NULL) -> None:
    """Raises what a call answered, with the message kept for its device (null: for this thread)."""
    if status == 0:
        return
    message = ffi.new("const char**")
    kept = lib.lwGetLastError(device, message)
    # Another thread of the same device may have failed first: then its message is kept, and ours is not.
    words = text(message[0]) if kept == status else "the message was another thread's; call again to see it"
    raise error_of(status, words)
