#include "techniques/rsm_shadows.h"

#include <algorithm>

#include "compute/device.h"

namespace lightwell {
namespace {

using Source = RsmShadows::Source;

// VPLs of one cluster share what it sees. Fewer: shadows with edges that the light has not; more: time where lights or surfaces move,
// and memory, by as much, and a pixel looks up more of them. docs/techniques/rsm.md#visibility has both.
constexpr std::uint32_t kClusters = 32;
// Of which a pixel takes one, as ssvp's cluster_groups.
constexpr std::uint32_t kGroups = 4;

KMeansOptions clusterOptions() {
    KMeansOptions options;
    options.clusters = kClusters;
    return options;
}

std::uint32_t groupsOf(const LWRsmDesc& desc) { return std::min(kGroups, desc.interleave * desc.interleave); }

std::uint32_t trianglesOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->triangleCount : 0; }
std::uint32_t surfelsOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->surfelCount : 0; }

Source bestOf(std::uint32_t triangles, std::uint32_t surfels) {
    return triangles ? Source::triangles : surfels ? Source::surfels : Source::screen;
}

const char* describe(Source source) {
    switch (source) {
        case Source::triangles:
            return "triangles: every voxel that they touch";
        case Source::surfels:
            return "the host's surfels: every voxel that they touch";
        default:
            return "voxels of RSM texels and source views, anew in every frame; what none of them shows blocks nothing";
    }
}

}  // namespace

RsmShadows::RsmShadows(Device& device, const LWRsmDesc& desc, Source source)
    : device_(device),
      desc_(desc),
      wanted_(source),
      shadows_(device, desc.voxels),
      clusters_(device, clusterOptions()),
      gather_(device, desc.interleave, groupsOf(desc), ClusterVisibility::voxel) {
    if (desc.autoResolution > 0.0f) gatherAll_.emplace(device, 1, 1, ClusterVisibility::voxel);
}

Source RsmShadows::sourceOf(const LWFrame& frame) const {
    return wanted_ == Source::best ? bestOf(trianglesOf(frame), surfelsOf(frame)) : wanted_;
}

void RsmShadows::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    if (source == Source::triangles) triangles_.check(frame);
    if (source == Source::surfels) SurfelInput::check(device_, frame.geometry);
    if (source == Source::screen) ScreenSurfels::check(device_, frame);
}

VoxelSurfaces RsmShadows::import(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    const Source source = sourceOf(frame);
    VoxelSurfaces surfaces;
    surfaces.isOther = source != source_;
    source_ = source;
    if (source == Source::triangles) {
        triangles_.import(executor, frame.geometry);
        surfaces.triangles = &triangles_;
    } else if (source == Source::surfels) {
        surfels_.import(executor, frame.geometry);
        surfaces.surfels = surfels_.surfels();
    } else {
        screen_.import(executor, frame, rsms);
        surfaces.surfels = screen_.surfels();
    }
    if (source != Source::screen) screen_.clear();
    return surfaces;
}

void RsmShadows::update(Executor& executor, const LWFrame& frame, const RsmInput& rsms, VplList vpls, bool restart, bool lost) {
    if (lost) {
        triangles_.forget();
        surfels_.forget();
    }
    shadows_.recordVoxels(executor, frame, rsms, import(executor, frame, rsms), restart);
    clusters_.record(executor, vpls.vpls, vpls.count, restart);
    shadows_.recordSights(executor, {{clusters_.clusters(), clusters_.clusterCount()}});
    std::vector<GatheredList> lists{{vpls, &clusters_.assignment(), clusters_.clusterCount()}};
    gather_.recordOrder(executor, lists);
    if (gatherAll_) gatherAll_->recordOrder(executor, lists);
    lists_ = std::move(lists);
    if (points_) points_->startFrame();
}

ClusterMaps RsmShadows::mapsRead(const VoxelSights& sights) const {
    // A kernel's argument must be some memory, also where it is not read.
    return {{{&sights.eyes, &sights.eyes, clusters_.clusterCount()}}, 0, &sights};
}

void RsmShadows::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& masks,
                              const Planes& irradiance, const Buffer& counts) {
    const VoxelSights sights = shadows_.sights();
    gather_.recordGather(executor, position, normal, masks,
                         VplTiles::layout(position.width, position.height, gather_.order(), desc_.interleave), mapsRead(sights),
                         irradiance, counts);
}

void RsmShadows::recordGatherAll(Executor& executor, const Planes& position, const Planes& normal, const Buffer& masks,
                                 const Planes& irradiance, const Buffer& counts) {
    const VoxelSights sights = shadows_.sights();
    gatherAll_->recordGather(executor, position, normal, masks, VplTiles::layout(position.width, position.height, gatherAll_->order(), 1),
                             mapsRead(sights), irradiance, counts);
}

void RsmShadows::renderPoints(Executor& executor, const Points& points) {
    if (!points_) points_.emplace(device_, ClusterVisibility::voxel);
    const VoxelSights sights = shadows_.sights();
    points_->render(executor, points, lists_, mapsRead(sights));
}

std::vector<LWChoice> RsmShadows::choices(const LWFrame& frame, bool viewsAreUsed) const {
    std::vector<LWChoice> choices = {{"occluders", describe(source_)}};
    if (frame.sourceViewCount && source_ != Source::screen && !viewsAreUsed)
        choices.push_back({"frame.sourceViews", "not used: they are no occluders, and technique rsm takes light from RSMs and "
                                                "authored VPLs only"});
    if (surfelsOf(frame) && source_ != Source::surfels)
        choices.push_back({"frame.geometry.surfels", "not used: they are no occluders"});
    return choices;
}

void RsmShadows::report(Report& report) const {
    if (source_ == Source::triangles) triangles_.report(report);
    if (source_ == Source::surfels) surfels_.report(report);
    if (source_ == Source::screen) screen_.report(report);
    report.counts.push_back({"clusters", clusters_.clusterCount()});
    shadows_.report(report);
    if (points_) points_->report(report);
}

std::uint64_t RsmShadows::bytes() const {
    return triangles_.bytes() + surfels_.bytes() + screen_.bytes() + shadows_.bytes() + clusters_.bytes() + gather_.bytes() +
           (gatherAll_ ? gatherAll_->bytes() : 0) +
           (points_ ? points_->bytes() : 0);
}

lw_subset_order RsmShadows::orderOf(const LWRsmDesc& desc, std::uint32_t count) {
    return ClusteredGather::orderOf({count}, desc.interleave);
}

std::uint64_t RsmShadows::estimateBytes(const LWRsmDesc& desc, std::uint32_t count, const FrameShape& shape) {
    const Source source = bestOf(shape.triangles, shape.surfels);
    const std::uint64_t surfaces = source == Source::triangles  ? GeometryInput::estimateBytes(shape.triangles)
                                   : source == Source::surfels ? SurfelInput::estimateBytes(shape.surfels, shape.uploads)
                                                               : ScreenSurfels::estimateBytes(shape);
    const std::uint64_t surfels = source == Source::triangles ? 0 : source == Source::surfels ? shape.surfels : shape.paddedTexels + shape.sourcePixels;
    return surfaces + VoxelShadows::estimateBytes(desc.voxels, kClusters, surfels, shape) +
           KMeans::estimateBytes(clusterOptions(), count) + ClusteredGather::estimateBytes({count}, 1, desc.interleave) +
           (desc.autoResolution > 0.0f ? ClusteredGather::estimateBytes({count}, 1, 1) : 0);
}

}  // namespace lightwell
