#include "techniques/occluder_maps.h"

#include <algorithm>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

using Source = OccluderMaps::Source;

Source chosenSource(const OccluderOptions& options, std::uint32_t triangles, std::uint32_t surfels) {
    if (!options.isWanted) return Source::none;
    const Source sampled = surfels ? Source::surfels : Source::sampledTriangles;
    switch (options.occluders) {
        case LW_OCCLUDERS_TRIANGLES:
            return Source::triangles;
        case LW_OCCLUDERS_SURFELS:
            return sampled;
        case LW_OCCLUDERS_SCREEN:
            return Source::screen;
        default:
            if (triangles || !(surfels || options.takesScreen)) return Source::triangles;
            return surfels ? Source::surfels : Source::screen;
    }
}

// What a frame without it is refused for.
const char* expectation(const OccluderOptions& options) {
    switch (options.occluders) {
        case LW_OCCLUDERS_TRIANGLES:
            return "triangles, as the technique's parameter occluders=triangles asks for them";
        case LW_OCCLUDERS_SURFELS:
            return "surfels or triangles, as the technique's parameter occluders=surfels asks for them";
        default:
            return "triangles or surfels, as the technique's parameter visibility asks for what may stand in the light's way";
    }
}

std::uint32_t trianglesOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->triangleCount : 0; }
std::uint32_t surfelsOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->surfelCount : 0; }
bool hasRsm(const LWFrame& frame) {
    return std::any_of(frame.lights, frame.lights + frame.lightCount, [](const LWLight& l) { return l.rsmCount > 0; });
}

const char* describe(Source source) {
    switch (source) {
        case Source::triangles:
            return "triangles, drawn exactly";
        case Source::surfels:
            return "the host's surfels, splatted";
        case Source::sampledTriangles:
            return "triangles, sampled to surfels by area and splatted";
        case Source::screen:
            return "RSM texels and source views, splatted anew in every frame";
        default:
            return "none: one bounce without visibility asks for no maps";
    }
}

// With visibility through voxels; what further bounces are drawn from is the same.
const char* describeVoxels(Source source) {
    switch (source) {
        case Source::surfels:
            return "the host's surfels: every voxel that they touch";
        case Source::screen:
            return "voxels of RSM texels and source views, anew in every frame";
        default:
            return "triangles: every voxel that they touch";
    }
}

}  // namespace

OccluderMaps::OccluderMaps(Device& device, const OccluderOptions& options, std::size_t stages)
    : device_(device), options_(options), sampling_(device) {
    for (std::size_t i = 0; i < stages; ++i) stages_.emplace_back(device, options.mapSize);
}

Source OccluderMaps::sourceOf(const LWFrame& frame) const {
    return chosenSource(options_, trianglesOf(frame), surfelsOf(frame));
}

void OccluderMaps::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    const bool drawsTriangles = source == Source::triangles || source == Source::sampledTriangles;
    if (drawsTriangles && trianglesOf(frame) == 0)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.geometry: expected ", expectation(options_), ", got none");
    // Without light there is nothing to shadow.
    if (source == Source::screen && options_.occluders == LW_OCCLUDERS_SCREEN && frame.vplCount && frame.sourceViewCount == 0 &&
        !hasRsm(frame))
        fail(LW_ERROR_INVALID_ARGUMENT, "frame: expected RSMs or sourceViews, as the technique's parameter "
             "occluders=screen asks for them, got neither");
    if (drawsTriangles) triangles_.check(frame);
    if (source == Source::surfels) SurfelInput::check(device_, frame.geometry);
    if (source == Source::screen) ScreenSurfels::check(device_, frame);
}

void OccluderMaps::forget() {
    triangles_.forget();
    hostSurfels_.forget();
    for (Stage& stage : stages_) stage.maps.redrawAll();
}

void OccluderMaps::import(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    const Source source = sourceOf(frame);
    isOther_ = source != source_;  // revisions count within a source
    if (isOther_)
        for (Stage& stage : stages_) stage.maps.redrawAll();
    source_ = source;
    switch (source) {
        case Source::triangles:
        case Source::sampledTriangles:
            triangles_.import(executor, frame.geometry);
            break;
        case Source::surfels:
            hostSurfels_.import(executor, frame.geometry);
            break;
        case Source::screen:
            screen_.import(executor, frame, rsms);
            break;
        default:
            break;
    }
    if (source != Source::screen) screen_.clear();
    if (isOther_ || revision() != revision_) ++generation_;
    revision_ = revision();
}

std::uint64_t OccluderMaps::revision() const {
    if (source_ == Source::surfels) return hostSurfels_.surfels().revision;
    return source_ == Source::triangles || source_ == Source::sampledTriangles ? triangles_.revision : 0;
}

VoxelSurfaces OccluderMaps::surfaces() const {
    VoxelSurfaces surfaces;
    const bool isTriangles = source_ == Source::triangles || source_ == Source::sampledTriangles;
    if (isTriangles) surfaces.triangles = &triangles_;
    else surfaces.surfels = surfels();
    surfaces.isOther = isOther_;
    return surfaces;
}

SurfelSet OccluderMaps::surfels() const {
    return source_ == Source::surfels ? hostSurfels_.surfels()
           : source_ == Source::screen ? screen_.surfels()
                                       : sampling_.surfels();
}

void OccluderMaps::record(Executor& executor, std::size_t index, const Buffer& clusters, std::uint32_t clusterCount) {
    draw(executor, index, clusters, clusterCount);
    if (options_.isStrict) stages_[index].maps.recordMarks(executor);
}

void OccluderMaps::draw(Executor& executor, std::size_t index, const Buffer& clusters, std::uint32_t clusterCount) {
    Stage& stage = stages_[index];
    if (!draws(index)) clusterCount = 0;
    if (!draws(index) || source_ == Source::triangles) {
        stage.maps.record(executor, clusters, clusterCount, triangles_);
        return;
    }
    if (source_ == Source::sampledTriangles && index == 0)
        sampling_.record(executor, triangles_, SurfelSplat::mostSurfels(options_.mapSize));
    const SurfelSet set = surfels();
    stage.maps.recordPlaces(executor, clusters, clusterCount, *set.diagonal, set.revision);
    stage.splat.record(executor, set, stage.maps.texels());
    stage.holes.record(executor, stage.maps.texels());
    stage.maps.noteDrawn(set.revision);
}

std::vector<LWChoice> OccluderMaps::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices = {{"occluders", options_.throughVoxels ? describeVoxels(source_) : describe(source_)}};
    if (usesViews() && !hasRsm(frame) && frame.sourceViewCount == 0)
        choices.push_back({"frame.geometry", "neither triangles, surfels, RSMs nor source views: nothing blocks, and there is "
                                             "no second bounce"});
    if (surfelsOf(frame) && source_ != Source::surfels)
        choices.push_back({"frame.geometry.surfels", "not used: they are no occluders"});
    if (trianglesOf(frame) && source_ != Source::triangles && source_ != Source::sampledTriangles)
        choices.push_back({"frame.geometry.triangles", "not used: they are no occluders"});
    return choices;
}

void OccluderMaps::report(Report& report) const {
    if (source_ == Source::surfels) hostSurfels_.report(report);
    else if (source_ == Source::screen) screen_.report(report);
    else triangles_.report(report);
    if (source_ == Source::sampledTriangles) report.counts.push_back({"surfels", sampling_.surfels().count});
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        stages_[i].maps.report(report);
        if (source_ != Source::triangles && draws(i)) stages_[i].holes.report(report);
    }
}

std::uint64_t OccluderMaps::bytes() const {
    std::uint64_t total = triangles_.bytes() + hostSurfels_.bytes() + screen_.bytes() + sampling_.bytes();
    for (const Stage& stage : stages_) total += stage.maps.bytes() + stage.splat.bytes() + stage.holes.bytes();
    return total;
}

std::uint64_t OccluderMaps::estimateBytes(const OccluderOptions& options, const std::vector<std::uint32_t>& clusterCounts,
                                      const FrameShape& shape) {
    const Source source = chosenSource(options, shape.triangles, shape.surfels);
    const std::uint32_t sampled = SurfelSplat::mostSurfels(options.mapSize);
    std::uint64_t total = 0;
    if (source == Source::triangles || source == Source::sampledTriangles) total += GeometryInput::estimateBytes(shape.triangles);
    if (source == Source::none || source == Source::triangles) {
        for (std::size_t i = 0; i < clusterCounts.size(); ++i)
            total += ParaboloidMap::estimateBytes(options.mapSize, source == Source::triangles && i < options.drawn ? clusterCounts[i] : 0);
        return total;
    }
    std::uint64_t surfels = 0;
    if (source == Source::surfels) {
        surfels = shape.surfels;
        total += SurfelInput::estimateBytes(shape.surfels, shape.uploads);
    } else if (source == Source::screen) {
        surfels = shape.paddedTexels + shape.sourcePixels;
        total += ScreenSurfels::estimateBytes(shape);
    } else {
        surfels = sampled;
        total += SurfelSampling::estimateBytes(shape.triangles, sampled);
    }
    for (std::size_t i = 0; i < clusterCounts.size(); ++i) {
        const std::uint32_t clusters = clusterCounts[i];
        total += i >= options.drawn ? ParaboloidMap::estimateBytes(options.mapSize, 0)
                                     : ParaboloidMap::estimatePlacesBytes(options.mapSize, clusters) +
                                           SurfelSplat::estimateBytes(surfels, clusters) +
                                           PullPush::estimateBytes(options.mapSize, clusters);
    }
    return total;
}

std::uint64_t OccluderMaps::voxelSurfels(const OccluderOptions& options, const FrameShape& shape) {
    const Source source = chosenSource(options, shape.triangles, shape.surfels);
    return source == Source::surfels ? shape.surfels : source == Source::screen ? shape.paddedTexels + shape.sourcePixels : 0;
}

}  // namespace lightwell
