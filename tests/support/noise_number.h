// Noise for tests that must be the same everywhere.
#pragma once

#include <cstdint>

namespace stability_test {

// A number in [-1,1], evenly spread, the same for the same arguments.
inline double noiseNumber(int a, int b, int c) {
    std::uint32_t h =
        std::uint32_t(a) * 0x9E3779B1u ^ std::uint32_t(b) * 0x85EBCA77u ^ std::uint32_t(c) * 0xC2B2AE3Du;
    for (int i = 0; i < 3; ++i) {
        h ^= h >> 15;
        h *= 0x2C1B3C6Du;
        h ^= h >> 12;
    }
    return double(h) / 2147483647.5 - 1.0;
}

}  // namespace stability_test
