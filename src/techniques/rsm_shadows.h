// Technique rsm with visibility=voxel: its VPLs in clusters, what these see past the voxels that the scene occupies, and the gather
// that asks it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/screen_surfels.h"
#include "inputs/surfel_input.h"
#include "passes/clustered_gather.h"
#include "passes/kmeans.h"
#include "passes/vpl_sampling.h"
#include "techniques/clustered_points.h"
#include "techniques/technique.h"
#include "techniques/voxel_shadows.h"

namespace lightwell {

class RsmShadows {
public:
    // What the voxels are made of.
    enum class Source { best, triangles, surfels, screen };

    // source: best: the first of the others that a frame has.
    RsmShadows(Device& device, const LWRsmDesc& desc, Source source = Source::best);

    // Throws what update() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame) const;
    // vpls: a list by index. restart: nothing of the frame before counts; lost: nor what was uploaded.
    void update(Executor& executor, const LWFrame& frame, const RsmInput& rsms, VplList vpls, bool restart, bool lost);
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& masks, const Planes& irradiance,
                      const Buffer& counts);
    // With desc.autoResolution: the same of all VPLs at each pixel, from a list of its own.
    void recordGatherAll(Executor& executor, const Planes& position, const Planes& normal, const Buffer& masks, const Planes& irradiance,
                         const Buffer& counts);
    const Buffer& wholeVpls() const { return gatherAll_->vpls(); }
    lw_subset_order wholeOrder() const { return gatherAll_->order(); }
    void renderPoints(Executor& executor, const Points& points);

    const Buffer& vpls() const { return gather_.vpls(); }  // as interleaved gathers cull them
    lw_subset_order order() const { return gather_.order(); }

    // What of the frame's geometry and views is used, and what is not.
    std::vector<LWChoice> choices(const LWFrame& frame, bool viewsAreUsed) const;  // ... by something else
    void report(Report& report) const;
    std::uint64_t bytes() const;
    // count: of all VPLs.
    static std::uint64_t estimateBytes(const LWRsmDesc& desc, std::uint32_t count, const FrameShape& shape);
    static lw_subset_order orderOf(const LWRsmDesc& desc, std::uint32_t count);
    static lw_subset_order wholeOrderOf(std::uint32_t count) { return ClusteredGather::orderOf({count}, 1); }

private:
    Source sourceOf(const LWFrame& frame) const;
    VoxelSurfaces import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    ClusterMaps mapsRead(const VoxelSights& sights) const;

    Device& device_;
    LWRsmDesc desc_;
    Source wanted_, source_ = Source::best;  // source_: of the last frame
    GeometryInput triangles_;
    SurfelInput surfels_;
    ScreenSurfels screen_;
    VoxelShadows shadows_;
    KMeans clusters_;
    ClusteredGather gather_;
    std::optional<ClusteredGather> gatherAll_;
    std::vector<GatheredList> lists_;  // of the last frame
    std::optional<ClusteredPoints> points_;
};

}  // namespace lightwell
