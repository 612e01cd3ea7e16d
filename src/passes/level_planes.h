// Planes of an image pyramid's levels in one allocation.
#pragma once

#include <vector>

#include "compute/buffer.h"

namespace lightwell {

struct LevelRange {
    std::uint32_t first = 0, last = 0;
};

// Level k has 1 / 2^k of the base's columns and rows, rounded up.
inline std::uint32_t levelSize(std::uint32_t base, std::uint32_t level) { return (base + (1u << level) - 1) >> level; }

inline std::uint32_t roundedUp(std::uint32_t value, std::uint32_t multiple) { return (value + multiple - 1) / multiple * multiple; }

// Lays levels of an image of this size out one behind the other, `count` planes each, without memory: rows rounded up
// to `multiple` columns with `border` more either side. Returns the floats that they take.
inline std::uint64_t layOutLevels(std::uint32_t width, std::uint32_t height, LevelRange range, std::uint32_t count,
                                  std::uint32_t multiple, std::uint32_t border, std::vector<Planes>* levels) {
    std::uint64_t at = 0;
    for (std::uint32_t k = range.first; k <= range.last; ++k) {
        Planes planes;
        planes.width = levelSize(width, k);
        planes.height = levelSize(height, k);
        planes.count = count;
        planes.rowStride = std::int64_t(roundedUp(planes.width, multiple)) + 2 * border;
        planes.planeStride = planes.rowStride * planes.height;
        planes.offset = std::int64_t(at) + border;
        at += std::uint64_t(planes.planeStride) * count;
        if (levels) levels->push_back(planes);
    }
    return at;
}

}  // namespace lightwell
