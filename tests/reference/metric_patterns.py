"""Deterministic pairs of small sRGB pictures, by integer formulas that metric_patterns.h repeats in C++."""
import numpy as np

WIDTH, HEIGHT = 64, 48
PATTERNS = ["ramp", "bars", "noise"]
CHANGES = ["offset", "shift", "grain", "swap"]
PROBES = [(0, 0), (63, 0), (5, 5), (31, 23), (32, 24), (40, 7), (12, 41), (63, 47)]


def scramble(x, y, c):
    h = ((x * 73856093) ^ (y * 19349663) ^ (c * 83492791)) & 0xFFFFFFFF
    h = (h * 2654435761) & 0xFFFFFFFF
    return (h ^ (h >> 15)) & 255


def code(pattern, x, y, c):
    if pattern == 0:
        return [x * 255 // (WIDTH - 1), y * 255 // (HEIGHT - 1), 128][c]
    if pattern == 1:
        return (200 if (x // 8 + y // 12) % 2 else 40) + 20 * c
    return scramble(x, y, c)


def changed(pattern, change, x, y, c):
    if change == 0:
        return min(code(pattern, x, y, c) + 10, 255)
    if change == 1:
        return code(pattern, min(x + 3, WIDTH - 1), y, c)
    if change == 2:
        return max(0, min(code(pattern, x, y, c) + scramble(x, y, c + 3) % 33 - 16, 255))
    return code(pattern, x, y, (c + 1) % 3)


def picture(value):
    return np.array([[[value(x, y, c) for c in range(3)] for x in range(WIDTH)] for y in range(HEIGHT)]) / 255.0


def pairs():
    """Yields (pattern index, change index, reference, test), values in [0,1]."""
    for p in range(len(PATTERNS)):
        reference = picture(lambda x, y, c: code(p, x, y, c))
        for d in range(len(CHANGES)):
            yield p, d, reference, picture(lambda x, y, c: changed(p, d, x, y, c))


def write_header(path, script, source, namespace, fields, rows):
    """One row per pair: the means, then the map's value at each probe."""
    with open(path, "w") as out:
        out.write(f"// Made by tests/reference/{script} from {source}; do not edit.\n#pragma once\n\n")
        out.write(f"namespace {namespace} {{\n\n")
        out.write("struct Row {\n    int pattern, change;\n    double " + ", ".join(fields) + f", probes[{len(PROBES)}];\n}};\n")
        out.write("constexpr Row kRows[] = {\n")
        for p, d, means, probes in rows:
            numbers = ", ".join(f"{v:.9g}" for v in means)
            out.write(f"    {{{p}, {d}, {numbers},\n     {{" + ", ".join(f"{v:.7g}" for v in probes) + "}},\n")
        out.write(f"}};\n\n}}  // namespace {namespace}\n")
