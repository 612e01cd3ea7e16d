"""The part of OpenEXR that the tests of the command line read: scan lines, ZIP or none, float and half.

Written from the file format's description, sharing nothing with the program under test.
"""
import struct
import zlib

_SIZES = {1: 2, 2: 4}  # pixel type: bytes (1 half, 2 float)


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data):
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0xFF != 2:
        raise ValueError("not an OpenEXR 2 file")
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        (size,) = struct.unpack_from("<I", data, at)
        attributes[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return attributes, at + 1


def _channels(blob):
    channels, at = [], 0
    while blob[at] != 0:
        name, at = _text(blob, at)
        (kind,) = struct.unpack_from("<I", blob, at)
        channels.append((name, kind))
        at += 16
    return channels


def _unzip(block, size):
    if len(block) == size:  # stored as it was, because it would not shrink
        return block
    raw = bytearray(zlib.decompress(block))
    for i in range(1, len(raw)):
        raw[i] = (raw[i] + raw[i - 1] - 128) & 0xFF
    half = (len(raw) + 1) // 2
    out = bytearray(len(raw))
    out[0::2], out[1::2] = raw[:half], raw[half:]
    return bytes(out)


def read(path):
    """(width, height, {channel: list of floats}, {string attribute: text})"""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = _header(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    channels = _channels(attributes["channels"][1])
    lines = {0: 1, 2: 1, 3: 16}[attributes["compression"][1][0]]
    planes = {name: [] for name, _ in channels}
    block_count = (height + lines - 1) // lines
    for offset in struct.unpack_from("<%dQ" % block_count, data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(lines, bottom + 1 - y)
        whole = rows * width * sum(_SIZES[kind] for _, kind in channels)
        block, pos = _unzip(data[offset + 8:offset + 8 + size], whole), 0
        for _ in range(rows):
            for name, kind in channels:
                planes[name].extend(struct.unpack_from("<%d%s" % (width, "e" if kind == 1 else "f"), block, pos))
                pos += width * _SIZES[kind]
    texts = {name: blob.decode() for name, (kind, blob) in attributes.items() if kind == "string"}
    return width, height, planes, texts
