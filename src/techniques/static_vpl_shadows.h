// Technique static_vpl's visibility: what its VPLs see of the frame's geometry, in maps or past voxels,
// as technique ssvp's clusters see it, and the gather that asks it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/rsm_input.h"
#include "passes/clustered_gather.h"
#include "passes/kmeans.h"
#include "passes/light_list.h"
#include "techniques/clustered_points.h"
#include "techniques/occluder_maps.h"
#include "techniques/technique.h"
#include "techniques/voxel_shadows.h"

namespace lightwell {

class StaticVplShadows {
public:
    StaticVplShadows(Device& device, const LWStaticVplDesc& desc);

    // Throws what update() would say of this frame.
    void check(const LWFrame& frame);
    // Once the list, which is dealt to one subset, is whole. opposite: of its VPLs the last so many,
    // which lie opposite others. restart: nothing of the frame before counts; lost: nor what was
    // uploaded.
    void update(Executor& executor, const LWFrame& frame, LightList& list, std::uint32_t opposite,
                bool restart, bool lost);
    // list: 0, or 1 of receivers with baked light.
    const Buffer& vpls(int list) const { return gathers_[std::size_t(list)].vpls(); }
    lw_subset_order order() const { return gathers_[0].order(); }
    void recordGather(Executor& executor, int list, const Planes& position, const Planes& normal,
                      const Buffer& masks, const Planes& irradiance, const Buffer& counts);
    void renderPoints(Executor& executor, int list, const Points& points);

    // What occludes, and who shares what.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    void addDebugViews(std::vector<DebugView>& views);
    std::uint64_t bytes() const;
    // others: VPLs beside the places, of which the last `opposite` lie opposite others.
    static std::uint64_t estimateBytes(const LWStaticVplDesc& desc, std::uint32_t others,
                                       std::uint32_t opposite, const FrameShape& shape);
    static lw_subset_order orderOf(const LWStaticVplDesc& desc, std::uint32_t count,
                                   std::uint32_t opposite);

private:
    // VPLs of the list that share what their clusters see, or see for themselves.
    KMeans& clusters() { return shares_ ? shared_ : own_; }
    const KMeans& clusters() const { return shares_ ? shared_ : own_; }
    // What the clusters see past voxels.
    void recordVoxels(Executor& executor, const LWFrame& frame, bool restart);
    ClusterMaps mapsRead(const VoxelSights* sights) const;
    std::vector<GatheredList> recordRest(Executor& executor, int list, const Buffer& vpls,
                                         std::uint32_t rest);

    Device& device_;
    LWStaticVplDesc desc_;
    OccluderMaps maps_;
    KMeans own_, shared_;
    bool shares_ = false;                 // in the last frame
    std::uint32_t shadowed_ = 0;          // VPLs of its list, the first ones
    std::optional<VoxelShadows> voxels_;  // with visibility through them only
    RsmInput noRsms_;
    Buffer sites_;
    std::array<Buffer, 2> rests_;  // VPLs that nothing shadows, by list
    std::array<ClusteredGather, 2> gathers_;
    std::array<std::vector<GatheredList>, 2> lists_;  // of the last frame
    std::array<std::optional<ClusteredPoints>, 2> points_;
};

}  // namespace lightwell
