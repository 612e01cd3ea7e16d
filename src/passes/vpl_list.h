// What passes that make lists of VPLs share on the host.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compute/executor.h"
#include "shared/subset_order.h"

namespace lightwell {

// A list of work-items in rows of at most 2^17, a multiple of every group and of no more groups (of 4 at least) than
// a grid may have without a driver telling it from a small one, whatever the list's length. See lw_list_index.
Range gridOver(std::size_t count);

// Two decorrelated numbers in [0,1) of a seed (Murmur's finaliser); (0, 0) for seed 0. `turns`: moved on by so many steps
// of the R2 sequence (Roberts 2018), so that the sets of any row of frames fill each other's gaps.
cl_float2 sampleRotation(std::uint32_t seed, std::uint32_t turns = 0);

// The slots of `count` VPLs dealt out to `subsets`. Throws UNSUPPORTED when they exceed the kernels' indices.
lw_subset_order subsetOrder(std::uint32_t count, std::uint32_t subsets);

}  // namespace lightwell
