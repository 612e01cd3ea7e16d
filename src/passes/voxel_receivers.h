// Voxels that light is gathered at, for further bounces (kernels/voxel_light/voxel_receivers.cl).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/voxel_light.h"
#include "passes/world_shift.h"

namespace lightwell {

// Of one of a volume's grids.
class VoxelReceivers {
public:
    // Room in the list for each slot of surfaces: a wall through a brick has 64 voxels, a corner of
    // three walls 169.
    static constexpr std::uint32_t kPerSlot = 128;
    static constexpr std::uint32_t kRow = 256;  // of position(), normal(), irradiance()

    VoxelReceivers(Device& device, std::uint32_t size);

    // Pass "voxel_light.receivers": the list of voxels that hold surfaces, where these have changed
    // since the last time. After VoxelMips::recordTables of the same surfaces.
    void record(Executor& executor, const VoxelSurfaces& surfaces, const Buffer& place,
                const VoxelMips& mips, VoxelLight& light);
    // Rows of receivers as points of a view, those behind the last one without a normal; and where
    // irradiance at them goes.
    Planes position() const { return planesFrom(points_, 0); }
    Planes normal() const { return planesFrom(points_, 3); }
    Planes irradiance() const { return planesFrom(gathered_, 0); }
    // Pass "voxel_light.hear": brings irradiance() to the voxels, where the next VoxelLight::record that
    // hears has it.
    void recordHeard(Executor& executor, VoxelLight& light);

    const Buffer& state() const { return state_; }  // LwVoxelReceivers
    // receivers, missing_receivers
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t slots);

private:
    Planes planesFrom(const Buffer& memory, std::uint32_t plane) const;

    Device& device_;
    std::uint32_t size_, slots_ = 0, room_ = 0;
    Kernel &count_, &scan_, &list_, &end_, &hear_;
    Buffer counts_, before_, points_, gathered_, voxels_, place_, state_;
    KeptPlaces kept_;  // place_; points are listed anew with all that is stale
};

}  // namespace lightwell
