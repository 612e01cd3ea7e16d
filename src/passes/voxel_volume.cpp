#include "passes/voxel_volume.h"

#include <algorithm>

#include "compute/device.h"

namespace lightwell {

bool VoxelVolume::reserve(Executor& executor, std::uint32_t baseSlotsEach, std::uint32_t mipSlotsEach) {
    Device& device = executor.device();
    const auto bricks = std::uint32_t(voxel_table(cl_int(size), 1));
    const std::uint32_t wantedBase = cascades * std::min(sparse ? baseSlotsEach : bricks, bricks);
    const std::uint32_t wantedMips =
        cascades * std::min(sparse ? mipSlotsEach : tableSize() - bricks, tableSize() - bricks);
    bool isNew = false;
    if (!state) {
        table = Buffer(device, std::size_t(cascades) * tableSize() * sizeof(cl_int),
                       "table of voxel bricks");
        state = Buffer(device, cascades * sizeof(LwVoxelState), "state of the voxels");
        executor.fill("voxel_mips.clear", table, 0xffffffffu, 0, table.bytes());  // LW_VOXEL_EMPTY
        executor.fill("voxel_mips.clear", state, 0, 0, state.bytes());
        isNew = true;
    }
    if (wantedBase > baseSlots) {
        base = Buffer(device, std::size_t(wantedBase) * basePlanes() * LW_VOXEL_STRIDE * sizeof(cl_uint),
                      "voxels");
        baseSlots = wantedBase;
        isNew = true;
    }
    if (wantedMips > mipSlots) {
        mips = Buffer(device, std::size_t(wantedMips) * mipPlanes() * LW_VOXEL_STRIDE * sizeof(cl_uint),
                      "coarser voxels");
        mipSlots = wantedMips;
        isNew = true;
    }
    return isNew;
}

}  // namespace lightwell
