// Lists of VPLs as a gather's tests deal them: slots in the order of the list, and tiles that skip none.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/vpl_tiles.h"

namespace lightwell::test {

inline lw_subset_order orderOf(std::size_t slots, std::uint32_t n) {
    lw_subset_order order{};
    order.subsets = cl_int(n * n);
    order.step = 1;
    order.capacity = cl_int(slots / (n * n));
    order.count = cl_int(slots);
    return order;
}

// Every slot of every subset for every tile.
inline std::vector<cl_uint> allSlots(const lw_vpl_tiles& layout, lw_subset_order order) {
    std::vector<cl_uint> masks;
    for (int word = 0; word < order.subsets * layout.words; ++word) {
        const int slots = std::min(32, order.capacity - word % layout.words * 32);
        masks.insert(masks.end(), std::size_t(lw_tile_stride(layout)), slots == 32 ? ~0u : (1u << slots) - 1u);
    }
    return masks;
}

}  // namespace lightwell::test
