// How far clusters of VPLs see the voxels of a grid that things lie in (kernels/voxel_visibility).
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/voxel_visibility_types.h"

namespace lightwell {

// What a gather reads of it.
struct VoxelSights {
    const Buffer& sights;  // LW_SIGHT_*, a byte each by cluster and voxel
    const Buffer& eyes;    // LwVoxelEye by cluster
    const Buffer& sight;   // LwVoxelSight
};

class VoxelVisibility {
public:
    struct Clusters {
        const Buffer& clusters;  // lw_cluster each
        std::uint32_t count;
    };

    // size: voxels a side; 16, 32, 64, 128, 256.
    VoxelVisibility(Device& device, std::uint32_t size);

    // Passes "voxel_visibility.*": of all lists' clusters, one list after the other, those anew that have moved, all where other
    // voxels hold something. place: LwGridPlace. occupied: a bit a voxel, in bricks of 512 (LW_VOXEL_BRICK).
    void record(Executor& executor, const Buffer& place, const Buffer& occupied, const std::vector<Clusters>& lists);
    // The next record() works out everything.
    void forget() { counts_.clear(); }

    VoxelSights sights() const { return {sights_, eyes_, sight_}; }
    std::uint32_t size() const { return size_; }
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t clusters);

private:
    void reserve(std::uint32_t clusters);
    void recordSweep(Executor& executor, std::uint32_t clusters);

    Device& device_;
    std::uint32_t size_;
    Kernel &solid_, &placeEyes_, &start_, &whole_, &across_, &along_;
    Buffer held_, solids_, sights_, eyes_, sight_;
    std::vector<std::uint32_t> counts_;  // of each list of the last record(); none: nothing is known
};

}  // namespace lightwell
