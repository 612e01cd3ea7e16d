// Which voxels of a grid surfaces touch, and of what kind these are (kernels/voxel_grid): conservative voxels (Schwarz and Seidel
// 2010), each with its surfaces' area (docs/techniques/voxel_grid.md). What lies where: kernels/shared/voxel_types.h.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/late_read.h"
#include "compute/report.h"
#include "inputs/geometry_input.h"
#include "inputs/surfel_set.h"
#include "passes/voxel_grid_bins.h"
#include "shared/voxel_grid_types.h"

namespace lightwell {

class VoxelGrid {
public:
    // Of which bricks surfaces are kept: all; only occupied ones, of which as many have slots as the frames so far have wanted; none,
    // where all that is read is which voxels are occupied.
    enum class Keeps { all, occupied, none };
    VoxelGrid(Device& device, std::uint32_t size, Keeps keeps);
    VoxelGrid(Device& device, std::uint32_t size, bool sparse) : VoxelGrid(device, size, keepsOf(sparse)) {}

    // Passes "voxel_grid.*". place: LwLpvPlace. Where the grid has not moved, only bricks that the triangles' changes touch are
    // made anew, and none where nothing has changed; what comes out is the same, to the bit, as all made anew.
    void record(Executor& executor, const GeometryInput& triangles, const Buffer& place);
    // Discs: each as the regular octagon of its area. Another revision: all anew.
    void record(Executor& executor, const SurfelSet& surfels, const Buffer& place);
    // The next record() makes all anew.
    void forget() {
        isKept_ = false;
        bins_.forget();
    }

    std::uint32_t size() const { return size_; }
    std::uint32_t slots() const { return slots_; }         // planes of surfaces() are slots() * LW_VOXEL_BRICK_VOXELS words each
    const Buffer& occupied() const { return occupied_; }   // LW_VOXEL_WORDS of each brick, also of those without a slot
    const Buffer& bricks() const { return bricks_; }       // slot of each brick or LW_VOXEL_EMPTY. One that stays occupied keeps it
    const Buffer& surfaces() const { return surfaces_; }   // LW_SURFACE_* of each slot; of slots without a brick: anything
    const Buffer& changed() const { return changed_; }     // of each brick, 1: the last record() has made it anew
    const Buffer& state() const { return state_; }         // LwVoxelGrid

    // voxels, voxel_bricks, dropped_bricks, outside_surfaces
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const;
    // Of `slots` bricks with surfaces; 0: as many as a new grid has. Of surfels: VoxelGridBins::estimateBytes more.
    static std::uint64_t estimateBytes(std::uint32_t size, Keeps keeps, std::uint32_t slots = 0);
    static std::uint64_t estimateBytes(std::uint32_t size, bool sparse, std::uint32_t slots = 0) {
        return estimateBytes(size, keepsOf(sparse), slots);
    }

private:
    enum class Source { kNone, kTriangles, kSurfels };

    static Keeps keepsOf(bool sparse) { return sparse ? Keeps::occupied : Keeps::all; }
    void reserve(Executor& executor);
    void grow();
    // emission: the largest one, or where among `found` it is.
    struct Emission {
        float largest;
        const Buffer* found;
    };
    void begin(Executor& executor, Source source, std::uint64_t revision, Emission emission, bool changesKnown, const Buffer& place);
    void mark(Executor& executor, const Buffer* boxes, const Buffer& place);
    void giveSlots(Executor& executor);
    void readCounts(Executor& executor);

    Device& device_;
    std::uint32_t size_, brickCount_, slots_ = 0;
    bool sparse_, fills_;
    Kernel &begin_, &mark_, &census_, &freeSlots_, &scan_, &listFree_, &give_, &occupy_, &fill_, &outside_, &occupySurfels_,
        &fillSurfels_;
    VoxelGridBins bins_;
    Buffer occupied_, bricks_, surfaces_, changed_, state_;
    Buffer list_, owners_, free_, chunks_;
    LateRead<LwVoxelGrid> counts_;  // the state of a frame ago, on its way to the host
    bool isKept_ = false;
    Source source_ = Source::kNone;
    std::uint64_t revision_ = 0;
};

}  // namespace lightwell
