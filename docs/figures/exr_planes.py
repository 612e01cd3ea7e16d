"""Planes of an EXR as numpy arrays: what tests/cli/exr.py reads value by value, by whole blocks; and the way back. Needs numpy."""
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


def write_planes(path, planes):
    """planes: arrays [height, width] by channel name; as floats, uncompressed."""
    names = sorted(planes)  # the order that the format asks for
    height, width = planes[names[0]].shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in names) + b"\0"
    attributes = [("channels", "chlist", channels), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
                  ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    size = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + (8 + size) * y for y in range(height)))
    rows = numpy.stack([planes[name] for name in names], axis=1).astype("<f4")  # [height, names, width]
    blocks = b"".join(struct.pack("<ii", y, size) + rows[y].tobytes() for y in range(height))
    path.write_bytes(header + offsets + blocks)
