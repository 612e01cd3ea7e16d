// Deterministic pairs of small sRGB pictures: the same integer formulas as metric_patterns.py, whose
// values flip_values.h and ssim_values.h hold.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace metric_patterns {

constexpr int kWidth = 64, kHeight = 48;
constexpr int kProbes[8][2] = {{0, 0}, {63, 0}, {5, 5}, {31, 23}, {32, 24}, {40, 7}, {12, 41}, {63, 47}};

inline int scramble(int x, int y, int c) {
    std::uint32_t h =
        (std::uint32_t(x) * 73856093u) ^ (std::uint32_t(y) * 19349663u) ^ (std::uint32_t(c) * 83492791u);
    h *= 2654435761u;
    return int((h ^ (h >> 15)) & 255u);
}

// 8-bit code of a pattern: 0 ramp, 1 bars, 2 noise.
inline int code(int pattern, int x, int y, int c) {
    if (pattern == 0)
        return std::array<int, 3>{x * 255 / (kWidth - 1), y * 255 / (kHeight - 1), 128}[std::size_t(c)];
    if (pattern == 1) return ((x / 8 + y / 12) % 2 != 0 ? 200 : 40) + 20 * c;
    return scramble(x, y, c);
}

// The pattern changed: 0 offset, 1 shift, 2 grain, 3 channels swapped.
inline int changed(int pattern, int change, int x, int y, int c) {
    if (change == 0) return std::min(code(pattern, x, y, c) + 10, 255);
    if (change == 1) return code(pattern, std::min(x + 3, kWidth - 1), y, c);
    if (change == 2) return std::clamp(code(pattern, x, y, c) + scramble(x, y, c + 3) % 33 - 16, 0, 255);
    return code(pattern, x, y, (c + 1) % 3);
}

}  // namespace metric_patterns
