// Technique ssvp's occluders, from which of the host's inputs, and the passes that draw maps of them.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/screen_surfels.h"
#include "inputs/surfel_input.h"
#include "passes/paraboloid_map.h"
#include "passes/pull_push.h"
#include "passes/surfel_sampling.h"
#include "passes/surfel_splat.h"
#include "techniques/technique.h"
#include "techniques/voxel_shadows.h"

namespace lightwell {

class SsvpMaps {
public:
    // Where a frame's maps come from.
    enum class Source { none, triangles, surfels, sampledTriangles, screen };

    // stages: bounces whose VPLs have clusters.
    SsvpMaps(Device& device, const LWSsvpDesc& desc, std::size_t stages);

    // Throws what import() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame) const;
    void import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    // After commands failed on the device: the next import() and record() do all anew.
    void forget();
    // The maps of a stage's clusters (lw_cluster each); drawn anew only where a medoid or what is drawn has moved. What the
    // screen shows moves with every frame.
    void record(Executor& executor, std::size_t stage, const Buffer& clusters, std::uint32_t clusterCount);

    // What voxels are made of, of the last import().
    VoxelSurfaces surfaces() const;

    const ParaboloidMap& maps(std::size_t stage) const { return stages_[stage].maps; }
    ParaboloidMap& maps(std::size_t stage) { return stages_[stage].maps; }

    // What of the frame's geometry and views is used, and what is not.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    std::uint64_t bytes() const;
    // clusterCounts: of each stage.
    static std::uint64_t estimateBytes(const LWSsvpDesc& desc, const std::vector<std::uint32_t>& clusterCounts,
                                       const FrameShape& shape);
    static std::uint64_t voxelSurfels(const LWSsvpDesc& desc, const FrameShape& shape);  // of surfaces(); 0 of triangles

private:
    struct Stage {
        Stage(Device& device, std::uint32_t size) : maps(device, size), splat(device), holes(device) {}
        ParaboloidMap maps;
        SurfelSplat splat;
        PullPush holes;
    };

    Source sourceOf(const LWFrame& frame) const;
    SurfelSet surfels() const;

    Device& device_;
    LWSsvpDesc desc_;
    Source source_ = Source::none;
    bool isOther_ = false;  // than in the import before
    GeometryInput triangles_;
    SurfelInput hostSurfels_;
    ScreenSurfels screen_;
    SurfelSampling sampling_;
    std::deque<Stage> stages_;
};

}  // namespace lightwell
