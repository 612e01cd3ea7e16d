"""The part of OpenEXR that the tests of the command line read (scan lines, ZIP or none, float and half) and write (no compression).

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


def write(path, width, height, planes, half=False, data_window=None):
    """{channel: list of floats}, row after row, without compression. `data_window`: left, top, right, bottom, where it is not all of the picture."""
    window = struct.pack("<4i", *(data_window or (0, 0, width - 1, height - 1)))
    whole = struct.pack("<4i", 0, 0, width - 1, height - 1)
    names = sorted(planes)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<IIii", 1 if half else 2, 0, 1, 1) for name in names) + b"\0"
    attributes = [("channels", "chlist", channels), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
                  ("displayWindow", "box2i", whole), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
                  ("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0)), ("screenWindowWidth", "float", struct.pack("<f", 1.0))]
    head = struct.pack("<II", 20000630, 2)
    for name, kind, blob in attributes:
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(blob)) + blob
    head += b"\0"
    left, top, right, bottom = struct.unpack("<4i", window)
    columns, rows = right - left + 1, bottom - top + 1
    blocks, at = [], len(head) + 8 * rows
    offsets = []
    for row in range(rows):
        line = b"".join(struct.pack("<%d%s" % (columns, "e" if half else "f"), *planes[name][row * columns:(row + 1) * columns]) for name in names)
        blocks.append(struct.pack("<ii", top + row, len(line)) + line)
        offsets.append(at)
        at += len(blocks[-1])
    with open(path, "wb") as file:
        file.write(head + struct.pack("<%dQ" % rows, *offsets) + b"".join(blocks))
