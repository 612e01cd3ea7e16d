// The levels of lit voxels, and which of their bricks have memory (kernels/voxel_mips).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/voxel_volume.h"
#include "shared/voxel_mips_types.h"

namespace lightwell {

// Of one of a volume's grids.
class VoxelMips {
public:
    VoxelMips(Device& device, std::uint32_t size, std::uint32_t cascade);

    // Passes "voxel_mips.tables": which bricks of all levels have memory, where some brick has changed
    // since the last time. occupied, changed: VoxelGrid's. all: whatever has changed, all words will be
    // written anew (new memory, say). Returns nothing to the host: work().moved says whether some
    // brick's slot is another.
    void recordTables(Executor& executor, const Buffer& occupied, const Buffer& changed, bool all,
                      const VoxelVolume& volume);
    // Passes "voxel_mips.apron" and "voxel_mips.filter": of bricks whose marks of the finest level are
    // set, and those above them.
    void recordFilter(Executor& executor, const VoxelVolume& volume);

    const Buffer& work() const { return work_; }  // LwVoxelWork
    // int of each brick of each level, in the table's order: 1 where its words have changed. Whoever
    // writes the finest level's words sets theirs, all of them, between the two calls.
    const Buffer& marks() const { return marks_; }
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size);

private:
    void reserve(Executor& executor);
    void recordApron(Executor& executor, const VoxelVolume& volume, std::uint32_t level);

    Device& device_;
    std::uint32_t size_, cascade_;
    Kernel &look_, &occupy_, &count_, &scan_, &assign_, &apron_, &isotropic_, &sides_, &harmonics_;
    Buffer work_, marks_, bits_, wanted_, counts_;
};

}  // namespace lightwell
