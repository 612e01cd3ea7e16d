// Light in voxels: what RSMs' texels, emissive surfaces and the last frame's own light make of a grid's
// surfaces (kernels/voxel_light), as words of the finest level of a VoxelVolume.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/rsm_input.h"
#include "passes/voxel_grid.h"
#include "passes/voxel_mips.h"
#include "passes/voxel_volume.h"
#include "shared/voxel_light_types.h"

namespace lightwell {

// What a VoxelGrid has made, or tests.
struct VoxelSurfaces {
    const Buffer &bricks, &surfaces, &changed, &state;
    std::uint32_t slots;
    static VoxelSurfaces of(const VoxelGrid& grid) {
        return {grid.bricks(), grid.surfaces(), grid.changed(), grid.state(), grid.slots()};
    }
};

// Of one of a volume's grids.
class VoxelLight {
public:
    VoxelLight(Device& device, std::uint32_t size, std::uint32_t cascade);

    // Passes "voxel_light.*", between the two of VoxelMips: words of bricks whose surfaces or light have
    // changed, and their marks. What comes out is the same, to the bit, as all made anew. place:
    // LwGridPlace. aware: LwVoxelContents', of a volume with sides.
    // hears: irradiance() counts, too.
    void record(Executor& executor, const RsmInput& rsms, const VoxelSurfaces& surfaces,
                const Buffer& place, const VoxelMips& mips, const VoxelVolume& volume, cl_int aware,
                bool hears = false);
    void forget() { isKept_ = false; }  // the next record() writes all words

    // Flux (W) of each colour, then where directions are told apart their sums:
    // [plane][slot][LW_VOXEL_BRICK_VOXELS].
    const Buffer& light() const { return light_; }
    const Buffer& state() const { return state_; }  // LwVoxelTexels, of the last record()
    // Irradiance of three colours that has come to each voxel, laid out as light(): recordHeard() of
    // VoxelReceivers writes it.
    const Buffer& irradiance() const { return irradiance_; }
    const Buffer& touched() const {
        return touched_;
    }  // LW_LIGHT_HEARD: who writes irradiance() that has changed sets it

    // outside_texels, lost_texels
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, LWVoxelMode mode, bool sides, bool hears,
                                       std::uint32_t slots, std::uint64_t texels);
    // Memory for irradiance() of so many slots, 0 where it is new.
    void reserveHeard(Executor& executor, std::uint32_t slots);

private:
    void reserve(Executor& executor, std::uint32_t slots, std::size_t texels,
                 const LwVoxelContents& contents);

    Device& device_;
    std::uint32_t size_, cascade_, slots_ = 0;
    std::size_t texels_ = 0;
    Kernel &locate_, &sort_, &settle_, &unit_, &resolve_;
    Buffer records_, order_, ends_, lit_, light_, irradiance_, touched_, largest_, state_;
    LwVoxelContents contents_{};  // of the last record()
    bool isKept_ = false;
};

}  // namespace lightwell
