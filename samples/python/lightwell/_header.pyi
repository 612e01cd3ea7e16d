# bind_header.py writes the module from lightwell.h when the package is built; cffi's objects have no types.
from typing import Any

ffi: Any
ABI: int
