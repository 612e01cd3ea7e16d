// Nested grids of light propagation volumes (kernels/lpv_cascades): what a coarser grid brings into a finer one that lies in it.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

// Which of several grids, numbered from the finest on, as kernels/shared/lpv_layers.h has them.
struct LpvLayer {
    std::uint32_t index = 0, count = 1;
};

// From the coarsest of `count` grids on, each going over what the coarser ones have written. Validity, without light, is the
// coarsest one's alone.
template <class Record>
void eachLayer(std::uint32_t count, bool hasLight, Record record) {
    for (std::uint32_t index = count; index-- > 0;)
        if (hasLight || index + 1 == count) record(LpvLayer{index, count});
}

// Two grids of `size` cells a side: cells half as large in the fine one.
struct LpvNested {
    const Buffer &fine, &coarse;  // LwLpvPlace
};

class LpvCascades {
public:
    LpvCascades(Device& device, std::uint32_t size);

    // Passes "lpv_cascades.add": to the fine grid's cells the light of coarse ones, `far`, of lights that do not lie in the fine grid.
    // Of LpvRead's cells.
    void recordSteps(Executor& executor, const LpvNested& grids, const Buffer& far, const Buffer& cells);
    // Of LpvSweep's. total: none, or cells that the light is added to as well. largest: bits of the largest that arrives at a side.
    void recordSweeps(Executor& executor, const LpvNested& grids, const Buffer& far, const Buffer& cells, const Buffer* total,
                      const Buffer& largest);

private:
    std::uint32_t size_;
    Kernel &addSteps_, &addSweeps_;
};

}  // namespace lightwell
