// Which texels around a receiver screen_gather samples, and how many texels each of them stands for.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/screen_types.h"

namespace lightwell {

// The ring between two radii in texels (inner 0: a disc) by `samples` texels for each of interleave^2 patterns, pattern
// by pattern. The weights of a pattern sum to the ring's area. With few enough texels in the ring, each is taken, weighted
// by what of it lies inside: all patterns are then alike. Otherwise one Hammersley set of all patterns' points is spread over
// the ring, and a point takes the texel that it lies in: each texel is hit in proportion to what of it lies in the ring, so
// that rings which touch leave no gap and do not overlap. `samples`, `interleave`: powers of two. seed 0: unshifted. Turn 1, 2, ..
// shift the set by a step of the R2 sequence each, within the cells that a pattern has one sample in: those of any row of
// frames fill each other's gaps.
//
// A texel that a ring's edge cuts sends from its middle all the same: rings of few texels take light from across their inner
// edges that the finer level has taken, too, by about 1 / r^2 of it (6 % at r = 4, 1 % at 8).
std::vector<LwScreenSample> screenPatterns(double inner, double outer, std::uint32_t samples, std::uint32_t interleave,
                                           std::uint32_t seed, std::uint32_t turn = 0);

// Whether the ring has few enough texels for that: all patterns are alike.
bool takesEveryTexel(double inner, double outer, std::uint32_t samples);

}  // namespace lightwell
