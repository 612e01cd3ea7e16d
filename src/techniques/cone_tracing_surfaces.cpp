#include "techniques/cone_tracing_surfaces.h"

#include "compute/error.h"

namespace lightwell {
namespace {

using Source = ConeTracingSurfaces::Source;

std::uint32_t trianglesOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->triangleCount : 0; }
std::uint32_t surfelsOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->surfelCount : 0; }

const char* describe(Source source) {
    switch (source) {
        case Source::triangles:
            return "the frame's triangles, every voxel that they touch";
        case Source::surfels:
            return "the frame's surfels";
        default:
            return "RSM texels and pixels of source views, in every frame anew; what none of them shows is not there";
    }
}

}  // namespace

Source ConeTracingSurfaces::chosen(LWVoxelSource source, std::uint32_t triangles, std::uint32_t surfels) {
    switch (source) {
        case LW_VOXEL_SOURCE_TRIANGLES:
            return Source::triangles;
        case LW_VOXEL_SOURCE_SURFELS:
            return Source::surfels;
        case LW_VOXEL_SOURCE_SCREEN:
            return Source::screen;
        default:
            return triangles ? Source::triangles : surfels ? Source::surfels : Source::screen;
    }
}

Source ConeTracingSurfaces::sourceOf(const LWFrame& frame) const {
    return chosen(desc_.source, hidden_ > 0 ? 0 : trianglesOf(frame), hidden_ > 1 ? 0 : surfelsOf(frame));
}

void ConeTracingSurfaces::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    if (source == Source::triangles) {
        if (trianglesOf(frame) == 0)
            fail(LW_ERROR_INVALID_ARGUMENT,
                 "frame.geometry: expected triangles, as the technique's parameter source=triangles asks for them, got none");
        triangles_.check(frame, true);
    }
    if (source == Source::surfels) {
        if (surfelsOf(frame) == 0)
            fail(LW_ERROR_INVALID_ARGUMENT,
                 "frame.geometry: expected surfels, as the technique's parameter source=surfels asks for them, got none");
        SurfelInput::check(device_, frame.geometry, true);
    }
    if (source == Source::screen) ScreenSurfels::check(device_, frame);
}

bool ConeTracingSurfaces::import(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    const Source source = sourceOf(frame);
    const bool isOther = source != source_;  // revisions count within a source
    source_ = source;
    if (source == Source::triangles) triangles_.import(executor, frame.geometry, true);
    if (source == Source::surfels) surfels_.import(executor, frame.geometry, true);
    if (source == Source::screen) screen_.import(executor, frame, rsms);
    else screen_.clear();
    return isOther;
}

void ConeTracingSurfaces::record(Executor& executor, VoxelGrid& grid, const Buffer& place) const {
    if (source_ == Source::triangles)
        grid.record(executor, triangles_, place);
    else
        grid.record(executor, source_ == Source::surfels ? surfels_.surfels() : screen_.surfels(), place);
}

std::vector<LWChoice> ConeTracingSurfaces::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices = {{"source", describe(source_)}};
    if (frame.sourceViewCount && source_ != Source::screen)
        choices.push_back({"frame.sourceViews", "not used: voxels are made of the frame's geometry"});
    if (surfelsOf(frame) && source_ != Source::surfels) choices.push_back({"frame.geometry.surfels", "not used: no voxels are made of them"});
    if (trianglesOf(frame) && source_ != Source::triangles)
        choices.push_back({"frame.geometry.triangles", desc_.extent == 0.0f ? "the grid reaches around them; no voxels are made of them"
                                                                            : "not used: no voxels are made of them"});
    return choices;
}

void ConeTracingSurfaces::report(Report& report) const {
    if (source_ == Source::triangles) triangles_.report(report);
    if (source_ == Source::surfels) surfels_.report(report);
    if (source_ == Source::screen) screen_.report(report);
}

std::uint64_t ConeTracingSurfaces::estimateBytes(const LWConeTracingDesc& desc, const FrameShape& shape) {
    const auto binBytes = [&](std::uint64_t surfels) { return desc.cascades * VoxelGridBins::estimateBytes(desc.size, surfels); };
    switch (chosen(desc.source, shape.triangles, shape.surfels)) {
        case Source::triangles:
            return GeometryInput::estimateBytes(shape.triangles, true);
        case Source::surfels:
            return SurfelInput::estimateBytes(shape.surfels, shape.uploads, true) + binBytes(shape.surfels);
        default:
            return ScreenSurfels::estimateBytes(shape) + binBytes(shape.paddedTexels + shape.sourcePixels);
    }
}

}  // namespace lightwell
