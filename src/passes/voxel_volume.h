// The scene as lit voxels, in the memory that cones read: passes voxel_light and voxel_mips fill it,
// cone_gather samples it.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "lightwell/lightwell.h"
#include "shared/voxel_format.h"

namespace lightwell {

// One grid of voxels, or several of the same size nested in each other, finest first. How words lie in
// memory: kernels/shared/ voxel_types.h; what they hold: voxel_format.h.
//
// A slot is a brick's memory, LW_VOXEL_STORED^3 voxels at x + 9 y + 81 z from word (plane * slots +
// slot) * LW_VOXEL_STRIDE on; those beyond the level's last voxels hold 0. Between voxels, a brick's
// memory answers for the corners (floor of position - 1/2) that are its own voxels. A brick without a
// slot holds nothing, and neither do its upper neighbours' first layers.
struct VoxelVolume {
    std::uint32_t size = 0;  // voxels a side of each grid
    std::uint32_t cascades = 1;
    LWVoxelMode mode = LW_VOXEL_MODE_ISOTROPIC;
    bool sparse = true;  // false: every brick has a slot
    bool sides = false;  // the finest level has six sides, of what faces each; whatever the mode

    std::uint32_t baseSlots = 0, mipSlots = 0;  // of all cascades together
    Buffer table;  // int: [cascade][voxel_table(size, level) + brick]: a slot of `base` (level 0) or
                   // `mips`, or LW_VOXEL_EMPTY
    Buffer base;   // words [plane][slot][LW_VOXEL_STRIDE] of the finest level
    Buffer mips;   // the same of the levels above
    Buffer state;  // LwVoxelState for each cascade

    std::uint32_t basePlanes() const {
        return std::uint32_t(voxel_base_planes(int(mode), sides ? 1 : 0));
    }
    std::uint32_t mipPlanes() const { return std::uint32_t(voxel_mip_planes(int(mode))); }
    std::uint32_t tableSize() const {
        return std::uint32_t(voxel_table_size(cl_int(size)));
    }  // of one cascade
    // Memory for so many slots of each grid, no more than there are bricks. True: some of it is new, and
    // what it holds anything.
    bool reserve(Executor& executor, std::uint32_t baseSlotsEach, std::uint32_t mipSlotsEach);
    std::uint64_t bytes() const { return table.bytes() + base.bytes() + mips.bytes() + state.bytes(); }
};

}  // namespace lightwell
