// What occludes the light of clusters of VPLs, from which of the host's inputs, and the passes that draw maps of it.
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

// What a technique asks of them.
struct OccluderOptions {
    LWOccluders occluders = LW_OCCLUDERS_AUTO;
    std::uint32_t mapSize = 128;
    std::size_t drawn = 1;       // the first so many stages have maps; those of the others are left empty
    bool isWanted = true;        // false: nothing asks for occluders
    bool isStrict = false;       // maps are marked for strict look-ups
    bool throughVoxels = false;  // the light goes past voxels; maps serve what is drawn from them
    // What RSMs and source views show may be occluders; else a frame without triangles and surfels is refused.
    bool takesScreen = true;
};

class OccluderMaps {
public:
    // Where a frame's maps come from.
    enum class Source { none, triangles, surfels, sampledTriangles, screen };

    // stages: bounces whose VPLs have clusters.
    OccluderMaps(Device& device, const OccluderOptions& options, std::size_t stages);

    // Throws what import() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame) const;
    void import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    // After commands failed on the device: the next import() and record() do all anew.
    void forget();
    // The maps of a stage's clusters (lw_cluster each); drawn anew only where a medoid or what is drawn has moved. What the
    // screen shows moves with every frame.
    void record(Executor& executor, std::size_t stage, const Buffer& clusters, std::uint32_t clusterCount);

    // Of a frame that keeps the maps of the one before: none is drawn anew.
    void recordKept(Executor& executor) {
        for (Stage& stage : stages_) {
            stage.maps.recordKept(executor);
            stage.holes.recordKept(executor);
        }
    }

    // Of what occludes: another number after an import() that may have changed some; 0: not known, as of what the screen shows.
    std::uint64_t generation() const { return source_ == Source::screen ? 0 : generation_; }

    // What voxels are made of, of the last import().
    VoxelSurfaces surfaces() const;

    const ParaboloidMap& maps(std::size_t stage) const { return stages_[stage].maps; }
    ParaboloidMap& maps(std::size_t stage) { return stages_[stage].maps; }

    bool usesViews() const { return source_ == Source::screen; }
    // What occludes, and what of the frame's geometry is not used.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    std::uint64_t bytes() const;
    // clusterCounts: of each stage.
    static std::uint64_t estimateBytes(const OccluderOptions& options, const std::vector<std::uint32_t>& clusterCounts,
                                       const FrameShape& shape);
    static std::uint64_t voxelSurfels(const OccluderOptions& options, const FrameShape& shape);  // of surfaces(); 0 of triangles

private:
    struct Stage {
        Stage(Device& device, std::uint32_t size) : maps(device, size), splat(device), holes(device) {}
        ParaboloidMap maps;
        SurfelSplat splat;
        PullPush holes;
    };

    void draw(Executor& executor, std::size_t stage, const Buffer& clusters, std::uint32_t clusterCount);
    Source sourceOf(const LWFrame& frame) const;
    std::uint64_t revision() const;
    bool draws(std::size_t stage) const { return source_ != Source::none && stage < options_.drawn; }
    SurfelSet surfels() const;

    Device& device_;
    OccluderOptions options_;
    Source source_ = Source::none;
    bool isOther_ = false;  // than in the import before
    std::uint64_t generation_ = 1, revision_ = 0;
    GeometryInput triangles_;
    SurfelInput hostSurfels_;
    ScreenSurfels screen_;
    SurfelSampling sampling_;
    std::deque<Stage> stages_;
};

}  // namespace lightwell
