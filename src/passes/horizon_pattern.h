// Where the horizon gather looks: which lines of the image a pixel's slices follow, and at which distances.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/horizon_types.h"

namespace lightwell {

struct HorizonPatternOptions {
    std::uint32_t directions = 16;  // slices in all: 4, 8, 16, 24, 40 or 48
    std::uint32_t density = 2;      // steps each time the distance doubles: 1, 2, 4 or 8
    std::uint32_t rows = 8;         // that share out the slices: a power of two that divides them
};

struct HorizonPattern {
    std::vector<lw_horizon_slice> slices;
    std::vector<lw_horizon_step> steps;
    std::uint32_t levels = 1;  // of the pyramid, the one that the gather runs on included
};

// reach: distance up to which a pixel looks, in pixels, of which each is `every` of the full image wide. At most
// LW_HORIZON_LEVELS levels.
HorizonPattern horizonPattern(const HorizonPatternOptions& options, double reach, double every);
// Levels that it has.
std::uint32_t horizonLevels(std::uint32_t density, double reach);

}  // namespace lightwell
