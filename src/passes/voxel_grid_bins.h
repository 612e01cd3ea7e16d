// Surfels by the bricks of a voxel grid that they lie in (kernels/voxel_grid/voxel_bins.cl).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/surfel_set.h"

namespace lightwell {

class VoxelGridBins {
public:
    VoxelGridBins(Device& device, std::uint32_t size);

    // Pass "voxel_grid.bins". state: VoxelGrid's, which says whether anything is to be done, and where surfels beyond the grid are
    // counted.
    void record(Executor& executor, const SurfelSet& surfels, const Buffer& place, const Buffer& state);
    void forget() { isCounted_ = false; }  // commands of a record() may not have run

    const Buffer& begins() const { return begins_; }  // bin_lists + 1: where each list begins in order()
    const Buffer& order() const { return order_; }    // surfels
    std::uint64_t bytes() const { return listOf_.bytes() + counts_.bytes() + chunks_.bytes() + begins_.bytes() + order_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint64_t surfelCount);

private:
    Device& device_;
    std::uint32_t size_;
    Kernel &count_, &addUp_, &scan_, &begin_, &list_;
    Buffer listOf_, counts_, chunks_, begins_, order_;
    bool isCounted_ = false;  // counts_ is 0 again: counted up and down
};

}  // namespace lightwell
