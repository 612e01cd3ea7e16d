"""Planes of an EXR as numpy arrays: what tests/cli/exr.py reads value by value, by whole blocks. Needs numpy."""
import struct
import sys
import zlib

import numpy

from program import ROOT

sys.path.insert(0, str(ROOT / "tests" / "cli"))
import exr  # noqa: E402

TYPES = {1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}


def read_planes(path, names=("R", "G", "B")):
    """An array [height, width, names] of float64."""
    data = path.read_bytes()
    attributes, at = exr._header(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    channels = [(name, TYPES[kind]) for name, kind in exr._channels(attributes["channels"][1])]
    row_bytes = width * sum(kind.itemsize for _, kind in channels)
    lines = {0: 1, 2: 1, 3: 16}[attributes["compression"][1][0]]
    planes = numpy.zeros((height, width, len(names)))
    for offset in struct.unpack_from("<%dQ" % ((height + lines - 1) // lines), data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(lines, bottom + 1 - y)
        block = unzip(data[offset + 8:offset + 8 + size], rows * row_bytes)
        pos = 0
        for row in range(y - top, y - top + rows):
            for name, kind in channels:
                if name in names:
                    planes[row, :, names.index(name)] = numpy.frombuffer(block, kind, width, pos)
                pos += width * kind.itemsize
    return planes


def unzip(block, size):
    if len(block) == size:  # stored as it was, because it would not shrink
        return block
    raw = numpy.frombuffer(zlib.decompress(block), numpy.uint8).astype(numpy.int64)
    raw[1:] -= 128
    raw = numpy.cumsum(raw).astype(numpy.uint8)
    out = numpy.empty(size, numpy.uint8)
    half = (size + 1) // 2
    out[0::2], out[1::2] = raw[:half], raw[half:]
    return out.tobytes()
