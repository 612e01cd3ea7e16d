"""What devices, views and techniques share: an owned handle, given back once, by `close`, a `with` block, garbage collection or
the interpreter's end; and what commands in flight still read and write."""
from __future__ import annotations

import os
import threading
import weakref
from typing import Any, Callable, List, Tuple, Type, TypeVar

from ._enums import Status
from ._errors import InvalidHandleError
from ._library import NULL, lib

Self = TypeVar("Self", bound="Handle")

# Handles whose owner was collected inside a log function, where the library takes no calls: with what must outlive them.
_deferred: List[Tuple[Callable[[Any], int], Any, Any, int]] = []


def release_deferred() -> None:
    """Gives back what could not be at its time."""
    waiting, _deferred[:] = _deferred[:], []
    for each in waiting:
        _release(*each)


def _release(release: Callable[[Any], int], handle: Any, kept: Any, process: int) -> None:
    if os.getpid() != process:
        return  # a fork: the driver's threads did not come along, and the handle is the parent's to give back
    if release(handle) == Status.REENTRANT:
        _deferred.append((release, handle, kept, process))


class InFlight:
    """Objects that commands on their way to the device rest on. A call adds its own *after* it has enqueued: whoever then
    takes the list before it waits holds nothing of a call that its wait does not cover."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: List[Any] = []

    def keep(self, kept: Any) -> None:
        with self._lock:
            self._kept.append(kept)

    def take(self) -> List[Any]:
        with self._lock:
            taken, self._kept = self._kept, []
        return taken

    def __len__(self) -> int:
        return len(self._kept)


def finish_and_release(in_flight: InFlight) -> Callable[[Any], int]:
    """How a device is given back: what is in flight is waited for, so that no command outlives the memory it writes."""
    def release(handle: Any) -> int:
        if len(in_flight):
            if lib.lwFinish(handle) == Status.REENTRANT:
                return int(Status.REENTRANT)
            in_flight.take()
        return int(lib.lwReleaseDevice(handle))
    return release


class Handle:
    """A handle of the library's and its end."""

    _what = "handle"

    def __init__(self, handle: Any, release: Callable[[Any], int], kept: Any = None) -> None:
        self._handle = handle
        self._process = os.getpid()
        self._end = weakref.finalize(self, _release, release, handle, kept, self._process)

    @property
    def handle(self) -> Any:
        """The C handle, for calls through cffi. Raises where this is closed."""
        if self._handle == NULL:
            raise InvalidHandleError(f"{self._what}: expected an open one, got one that was closed")
        if os.getpid() != self._process:
            raise InvalidHandleError(f"{self._what}: expected one that this process made, got one from before a fork")
        return self._handle

    def __reduce__(self) -> "str | Tuple[Any, ...]":
        raise TypeError(f"{self._what}: a handle of this process cannot be copied or pickled; make another one")

    @property
    def closed(self) -> bool:
        return bool(self._handle == NULL)

    def close(self) -> None:
        """Gives the handle back; again: nothing. What still needs it (a device's views) keeps the C object."""
        self._handle = NULL
        self._end()

    def __enter__(self: Self) -> Self:
        self.handle
        return self

    def __exit__(self, kind: "Type[BaseException] | None", error: Any, trace: Any) -> None:
        self.close()
