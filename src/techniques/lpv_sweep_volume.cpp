#include "techniques/lpv_sweep_volume.h"

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

// Surfels that triangles are drawn as, for each cell of a face of the grid: what covers a cell is then known to some percent.
// Fewer: walls of a cell's size leak; more: time, when triangles change.
constexpr std::uint32_t kSurfelsPerSide = 256;
// Of sampled surfels' areas, so that the chance of the draw leaves no holes in a wall. More: half covered cells are closed.
constexpr float kSampledArea = 1.25f;

// Of triangles' area, in faces of the grid: from there on fewer than 6.4 surfels come to a cell's side. A closed wall lets
// through 1 to 2 % of the light then, 4 to 6 % with half as many, 40 % with a tenth.
constexpr double kMostFaces = 40.0;

std::uint32_t sampledCount(const LWLpvDesc& desc) { return kSurfelsPerSide * desc.size * desc.size; }

LpvSweepOptions optionsOf(const LWLpvDesc& desc) {
    LpvSweepOptions options;
    options.size = desc.size;
    options.directions = desc.directions;
    options.bounces = desc.bounces;
    options.frames = desc.frames;
    return options;
}

const LWLpvDesc& checked(const LWLpvDesc& desc) {
    if (desc.size > LpvSweep::kLargestSize)
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.size: expected at most ", LpvSweep::kLargestSize, " with transport=sweep, got ",
             desc.size);
    return desc;
}

}  // namespace

LpvSweepVolume::LpvSweepVolume(Device& device, const LWLpvDesc& desc, int hidden)
    : device_(device),
      desc_(checked(desc)),
      hidden_(hidden),
      sampling_(device),
      grid_(device, desc.size),
      sweep_(device, optionsOf(desc)),
      specular_(device, desc.size, desc.frames > 1) {}

void LpvSweepVolume::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    if (source == Source::triangles) triangles_.check(frame.geometry);
    if (source == Source::surfels) SurfelInput::check(device_, frame.geometry);
}

void LpvSweepVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms,
                            const LpvPlacement& placement) {
    grid_.recordPlace(executor, rsms, frame.vpls, frame.vplCount, placement);
    Source source = sourceOf(frame);
    SurfelSet set;
    if (source == Source::triangles) {
        triangles_.import(executor, frame.geometry);
        sampling_.record(executor, triangles_, sampledCount(desc_));
        set = sampling_.surfels();
        if (triangles_.triangleCount == 0) source = Source::none;
    } else if (source == Source::surfels) {
        surfels_.import(executor, frame.geometry);
        set = surfels_.surfels();
    }
    const bool restart = placement.refit || source != source_;  // revisions count within a source
    sweep_.record(executor, {rsms, grid_.authored(), frame.vplCount, grid_.place(), set,
                             source == Source::triangles ? kSampledArea : 1.0f, restart, &specular_});
    source_ = source;
}

std::vector<LWChoice> LpvSweepVolume::choices(const LWFrame& frame, double side) const {
    std::vector<LWChoice> choices = {
        {"blockers", source_ == Source::triangles ? "triangles, sampled to surfels by area"
                     : source_ == Source::surfels ? "the host's surfels"
                                                  : "the texels of all RSMs: what no light sees blocks nothing"}};
    if (frame.sourceViewCount)
        choices.push_back({"frame.sourceViews", "not used: they block nothing, and technique lpv takes light from RSMs and "
                                                "authored VPLs only"});
    if (source_ == Source::none && desc_.bounces > 1)
        choices.push_back({"bounces", "one: without triangles and surfels there is nothing to send light on"});
    if (source_ == Source::none && frame.geometry && sourceOf(frame) == Source::triangles)
        choices.push_back({"frame.geometry", "not used: no triangle has an area and lies within reach"});
    if (source_ == Source::triangles && triangles_.area > kMostFaces * side * side)
        choices.push_back({"blockers.holes", "triangles of more than 40 faces of the grid: too few surfels for each cell to be closed"});
    if (source_ == Source::triangles && frame.geometry->surfelCount)
        choices.push_back({"frame.geometry.surfels", "not used: the triangles are"});
    return choices;
}

void LpvSweepVolume::report(Report& report) const {
    if (source_ == Source::triangles) {
        triangles_.report(report);
        report.counts.push_back({"surfels", sampling_.surfels().count});
    } else if (source_ == Source::surfels) {
        surfels_.report(report);
    }
    report.counts.push_back({"lights_outside", 0});
    if (sweep_.outside()) report.read(device_, "lights_outside", sweep_.outside(), 0);
}

std::uint64_t LpvSweepVolume::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    std::uint64_t total = LpvGrid::estimatePlaceBytes(shape.vplCount) + LpvSweep::estimateBytes(optionsOf(checked(desc))) +
                          LpvSpecular::estimateBytes(desc.size, desc.frames > 1);
    const Source source = sourceOf(shape.surfels, shape.triangles);
    if (source == Source::triangles)
        total += GeometryInput::estimateBytes(shape.triangles) + SurfelSampling::estimateBytes(shape.triangles, sampledCount(desc));
    if (source == Source::surfels) total += SurfelInput::estimateBytes(shape.surfels, shape.uploads);
    return total;
}

}  // namespace lightwell
