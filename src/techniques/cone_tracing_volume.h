// Technique cone_tracing's world part: where grids lie, their voxels, the light in them and its levels.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "compute/late_read.h"
#include "inputs/frame_shape.h"
#include "inputs/geometry_box.h"
#include "inputs/rsm_input.h"
#include "passes/cone_gather.h"
#include "passes/grid_place.h"
#include "passes/voxel_grid.h"
#include "passes/voxel_light.h"
#include "passes/voxel_mips.h"
#include "passes/voxel_receivers.h"
#include "techniques/cone_tracing_surfaces.h"
#include "techniques/technique.h"

namespace lightwell {

class ConeTracingVolume {
public:
    // hidden: ConeTracingSurfaces'.
    ConeTracingVolume(Device& device, const LWConeTracingDesc& desc, int hidden);

    // Throws what record() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame);
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, bool refit);

    // What cones are traced in; of the last record().
    ConeWorld world() const { return {volume_, places_.table(), environment_}; }

    // What of the last record's frame was used, and what not.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    void addDebugViews(std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWConeTracingDesc& desc, const FrameShape& shape);

private:
    GridPlacement placementOf(const LWFrame& frame, bool refit) const;
    void growSlots();
    void recordBounce(Executor& executor);

    Device& device_;
    LWConeTracingDesc desc_;
    GeometryBox box_;
    ConeTracingSurfaces surfaces_;
    GridPlaces places_;
    std::vector<std::unique_ptr<VoxelGrid>> grids_;  // from the finest on, as all below
    std::vector<std::unique_ptr<VoxelMips>> mips_;
    std::vector<std::unique_ptr<VoxelLight>> lights_;
    std::vector<std::unique_ptr<LateRead<LwVoxelWork>>> wanted_;  // slots that frames have wanted
    VoxelVolume volume_;
    std::unique_ptr<ConeGather> bounce_;  // with further bounces, as the next two
    std::vector<std::unique_ptr<VoxelReceivers>> receivers_;
    Buffer bounceCounts_;
    std::uint32_t baseSlots_, mipSlots_;  // that each grid has room for
    float environment_[3] = {0.0f, 0.0f, 0.0f};
};

}  // namespace lightwell
