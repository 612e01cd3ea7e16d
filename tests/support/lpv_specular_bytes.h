// What technique lpv holds of specular radiance once it is asked for it, with images used in place.
#pragma once

#include <cstdint>

namespace lightwell::test {

// Cells of 16 floats, and four and two beside, each level's side half the one's before, to four cells.
inline std::uint64_t specularCellBytes(std::uint64_t size) {
    std::uint64_t cells = 0;
    for (std::uint64_t n = size; n >= 4; n /= 2) cells += n * n * n;
    return cells * (16 + 4 + 2) * 4;
}

// Four counts, and at half resolution radiance, roughness and two counts. Sizes in pixels, columns with their padding.
inline std::uint64_t specularViewBytes(std::uint64_t halfPixels) { return 4 * 4 + (halfPixels ? 4 * 4 * halfPixels + 2 * 4 : 0); }

// Of a roughness image and an output that have to be unpacked and packed.
inline std::uint64_t specularUnpackedBytes(std::uint64_t pixels) { return (1 + 3) * 4 * pixels; }

}  // namespace lightwell::test
