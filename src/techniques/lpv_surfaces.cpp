#include "techniques/lpv_surfaces.h"

#include <algorithm>

#include "compute/device.h"

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

// Several grids: the surfels that send light on, four times as many for each finer grid but no more in all than so many (or than one
// grid's). In finer grids than they suffice for, light that is sent on comes from too few cells.
constexpr std::uint64_t kMostSending = std::uint64_t(1) << 22;

std::uint64_t surfelsOfOne(const LWLpvDesc& desc) { return kSurfelsPerSide * std::uint64_t(desc.size) * desc.size; }
std::uint64_t surfelsWanted(const LWLpvDesc& desc) { return surfelsOfOne(desc) << 2 * (desc.cascades - 1); }

std::uint32_t sampledCount(const LWLpvDesc& desc) {
    if (desc.cascades == 1) return std::uint32_t(surfelsOfOne(desc));
    return desc.bounces == 1 ? 0 : std::uint32_t(std::max(surfelsOfOne(desc), std::min(surfelsWanted(desc), kMostSending)));
}

}  // namespace

LpvSurfaces::LpvSurfaces(Device& device, const LWLpvDesc& desc, int hidden)
    : device_(device), desc_(desc), hidden_(hidden), sampling_(device) {}

void LpvSurfaces::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    if (source == Source::triangles) triangles_.check(frame);
    if (source == Source::surfels) SurfelInput::check(device_, frame.geometry);
}

bool LpvSurfaces::import(Executor& executor, const LWFrame& frame) {
    Source source = sourceOf(frame);
    set_ = SurfelSet{};
    if (source == Source::triangles) {
        triangles_.import(executor, frame.geometry);
        sampling_.record(executor, triangles_, sampledCount(desc_));
        set_ = sampling_.surfels();
        if (triangles_.triangleCount == 0) source = Source::none;
    } else if (source == Source::surfels) {
        surfels_.import(executor, frame.geometry);
        set_ = surfels_.surfels();
    }
    areaScale_ = source == Source::triangles ? kSampledArea : 1.0f;
    const bool isOther = source != source_;  // revisions count within a source
    source_ = source;
    return isOther;
}

std::vector<LWChoice> LpvSurfaces::choices(const LWFrame& frame, double side) const {
    std::vector<LWChoice> choices = {
        {"blockers", triangles()                    ? "triangles, 16 samples to a cell's side"
                     : source_ == Source::triangles ? "triangles, sampled to surfels by area"
                     : source_ == Source::surfels ? "the host's surfels"
                                                  : "the texels of all RSMs: what no light sees blocks nothing"}};
    if (frame.sourceViewCount)
        choices.push_back({"frame.sourceViews", "not used: they block nothing, and technique lpv takes light from RSMs, "
                                                "authored VPLs and the environment only"});
    if (source_ == Source::none && desc_.bounces > 1)
        choices.push_back({"bounces", "one: without triangles and surfels there is nothing to send light on"});
    if (source_ == Source::none && frame.geometry && sourceOf(frame) == Source::triangles)
        choices.push_back({"frame.geometry", "not used: no triangle has an area and lies within reach"});
    if (source_ == Source::triangles && !triangles() && triangles_.area > kMostFaces * side * side)
        choices.push_back({"blockers.holes", "triangles of more than 40 faces of the grid: too few surfels for each cell to be closed"});
    if (triangles() && desc_.bounces > 1 && surfelsWanted(desc_) > kMostSending)
        choices.push_back({"bounces.surfels", "4,194,304 send light on, fewer than the finest grid wants: it is sent from too few of its cells"});
    if (source_ == Source::triangles && frame.geometry->surfelCount)
        choices.push_back({"frame.geometry.surfels", "not used: the triangles are"});
    return choices;
}

void LpvSurfaces::report(Report& report) const {
    if (source_ == Source::triangles) {
        triangles_.report(report);
        report.counts.push_back({"surfels", sampling_.surfels().count});
    } else if (source_ == Source::surfels) {
        surfels_.report(report);
    }
}

std::uint64_t LpvSurfaces::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    const Source source = sourceOf(shape.surfels, shape.triangles);
    if (source == Source::triangles)
        return GeometryInput::estimateBytes(shape.triangles) + SurfelSampling::estimateBytes(shape.triangles, sampledCount(desc));
    return source == Source::surfels ? SurfelInput::estimateBytes(shape.surfels, shape.uploads) : 0;
}

}  // namespace lightwell
