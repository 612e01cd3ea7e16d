#include "techniques/lpv_geometry.h"

#include <cstddef>

#include "compute/device.h"
#include "compute/error.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

using Source = LpvGeometry::Source;

// Surfels that triangles are sampled to, for each of a side's cells squared: where they have as much area as twenty of the grid's
// sides, six of them to a cell's. Fewer: walls get holes; more: time, when the triangles or the grid's place change.
constexpr std::uint32_t kSurfelsOfSide = 128;

std::uint32_t sampledCount(const LWLpvDesc& desc) { return kSurfelsOfSide * desc.size * desc.size; }

// Several grids take the triangles as they are, each on a lattice of its own.
bool draws(const LWLpvDesc& desc) { return desc.cascades == 1; }

// Nested grids of one size, or the levels of a pyramid.
std::uint32_t gridsOf(const LWLpvDesc& desc, std::uint32_t levels) { return desc.cascades > 1 ? desc.cascades : levels; }
std::uint32_t sizeOf(const LWLpvDesc& desc, std::uint32_t grid) { return desc.cascades > 1 ? desc.size : desc.size >> grid; }

Source chosenSource(LWGeometryVolume volume, std::uint32_t triangles, std::uint32_t surfels) {
    switch (volume) {
        case LW_GEOMETRY_VOLUME_OFF:
            return Source::none;
        case LW_GEOMETRY_VOLUME_TRIANGLES:
            return Source::triangles;
        case LW_GEOMETRY_VOLUME_SURFELS:
            return surfels ? Source::surfels : Source::triangles;
        case LW_GEOMETRY_VOLUME_SCREEN:
            return Source::screen;
        default:
            return triangles ? Source::triangles : surfels ? Source::surfels : Source::screen;
    }
}

std::uint32_t trianglesOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->triangleCount : 0; }
std::uint32_t surfelsOf(const LWFrame& frame) { return frame.geometry ? frame.geometry->surfelCount : 0; }

const char* describe(Source source, bool draws) {
    switch (source) {
        case Source::triangles:
            return draws ? "triangles, sampled to surfels by area" : "triangles, 16 samples to a cell's side";
        case Source::surfels:
            return "the host's surfels";
        case Source::screen:
            return "RSM texels and source views, anew in every frame; what none of them shows blocks nothing";
        default:
            return "off: nothing blocks light";
    }
}

}  // namespace

LpvGeometry::LpvGeometry(Device& device, const LWLpvDesc& desc, std::uint32_t levels) : device_(device), desc_(desc) {
    if (desc.geometryVolume == LW_GEOMETRY_VOLUME_OFF) return;
    sampling_.emplace(device);
    for (std::uint32_t grid = 0; grid < gridsOf(desc, levels); ++grid)
        blockings_.push_back(std::make_unique<LpvBlocking>(device, sizeOf(desc, grid)));
}

Source LpvGeometry::sourceOf(const LWFrame& frame) const {
    return chosenSource(desc_.geometryVolume, trianglesOf(frame), surfelsOf(frame));
}

void LpvGeometry::check(const LWFrame& frame) const {
    const Source source = sourceOf(frame);
    if (source == Source::triangles) {
        if (trianglesOf(frame) == 0)
            fail(LW_ERROR_INVALID_ARGUMENT, "frame.geometry: expected ",
                 desc_.geometryVolume == LW_GEOMETRY_VOLUME_TRIANGLES
                     ? "triangles, as the technique's parameter geometry_volume=triangles asks for them"
                     : "surfels or triangles, as the technique's parameter geometry_volume=surfels asks for them",
                 ", got none");
        triangles_.check(frame);
    }
    if (source == Source::surfels) SurfelInput::check(device_, frame.geometry);
    if (source == Source::screen) ScreenSurfels::check(device_, frame);
}

void LpvGeometry::forget() {
    triangles_.forget();
    hostSurfels_.forget();
    forgetBlockers();
}

void LpvGeometry::forgetBlockers() {
    for (const std::unique_ptr<LpvBlocking>& blocking : blockings_) blocking->forget();
}

void LpvGeometry::import(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    const Source source = sourceOf(frame);
    if (source != source_) forgetBlockers();  // revisions count within a source
    source_ = source;
    if (source == Source::triangles) {
        triangles_.import(executor, frame.geometry);
        if (draws(desc_)) sampling_->record(executor, triangles_, sampledCount(desc_));
    }
    if (source == Source::surfels) hostSurfels_.import(executor, frame.geometry);
    if (source == Source::screen) importScreen(executor, frame, rsms);
    else screen_.clear();
}

// A light's maps see each surface once between them; what several lights and views see is one surface all the same.
void LpvGeometry::importScreen(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    screen_.import(executor, frame, rsms);
    views_.clear();
    for (std::size_t i = 0; i < rsms.spans.size(); ++i) {
        const RsmSpan& span = rsms.spans[i];
        const std::uint32_t end = i + 1 < rsms.spans.size() ? rsms.spans[i + 1].firstTexel : rsms.texels.width;
        if (i == 0 || span.light != rsms.spans[i - 1].light) views_.push_back({span.firstTexel, 0});
        views_.back().count += end - span.firstTexel;
    }
    std::uint32_t first = rsms.texels.width;
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWImage& image = frame.sourceViews[i].gbuffer->normal;
        views_.push_back({first, paddedWidth(image.width) * image.height});
        first += views_.back().count;
    }
}

std::optional<LpvBlockers> LpvGeometry::record(Executor& executor, const Buffer& place, std::size_t grid) {
    if (blockings_.empty()) return std::nullopt;
    LpvBlocking& blocking = *blockings_[grid];
    if (source_ == Source::triangles && !draws(desc_)) {
        blocking.record(executor, triangles_, place);
        return blocking.blockers();
    }
    const SurfelSet set = source_ == Source::screen    ? screen_.surfels()
                          : source_ == Source::surfels ? hostSurfels_.surfels()
                                                       : sampling_->surfels();
    const std::vector<SurfelRange> all = {{0, set.count}};
    blocking.record(executor, set, source_ == Source::screen ? views_ : all, place);
    return blocking.blockers();
}

std::vector<LWChoice> LpvGeometry::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices = {{"geometry_volume", describe(source_, draws(desc_))}};
    if (frame.sourceViewCount && source_ != Source::screen)
        choices.push_back({"frame.sourceViews", "not used: they block nothing, and technique lpv takes light from RSMs, "
                                                "authored VPLs and the environment only"});
    if (surfelsOf(frame) && source_ != Source::surfels)
        choices.push_back({"frame.geometry.surfels", "not used: they block nothing"});
    if (trianglesOf(frame) && source_ != Source::triangles)
        choices.push_back({"frame.geometry.triangles", desc_.extent == 0.0f ? "the grid reaches around them; they block nothing"
                                                                            : "not used: they block nothing"});
    return choices;
}

void LpvGeometry::report(Report& report) const {
    if (source_ == Source::none) return;
    if (source_ == Source::surfels) hostSurfels_.report(report);
    if (source_ == Source::screen) screen_.report(report);
    if (source_ == Source::triangles) {
        triangles_.report(report);
        if (draws(desc_)) report.counts.push_back({"surfels", sampling_->surfels().count});
    }
    report.counts.push_back({"surfels_outside", 0});
    // Finer cascades lie in the coarsest; a pyramid's levels all lie in one place, and the finest has the sharpest border.
    const Buffer& state = (desc_.cascades > 1 ? blockings_.back() : blockings_.front())->state();
    if (state) report.read(device_, "surfels_outside", state, offsetof(LwLpvBlockers, surfelsOutside));
}

std::uint64_t LpvGeometry::bytes() const {
    std::uint64_t total = triangles_.bytes() + hostSurfels_.bytes() + screen_.bytes() + (sampling_ ? sampling_->bytes() : 0);
    for (const std::unique_ptr<LpvBlocking>& blocking : blockings_) total += blocking->bytes();
    return total;
}

std::uint64_t LpvGeometry::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape, std::uint32_t levels) {
    const Source source = chosenSource(desc.geometryVolume, shape.triangles, shape.surfels);
    std::uint64_t total = 0;
    for (std::uint32_t grid = 0; source != Source::none && grid < gridsOf(desc, levels); ++grid)
        total += LpvBlocking::estimateBytes(sizeOf(desc, grid), source == Source::triangles && !draws(desc));
    if (source == Source::triangles) total += GeometryInput::estimateBytes(shape.triangles);
    if (source == Source::triangles && draws(desc)) total += SurfelSampling::estimateBytes(shape.triangles, sampledCount(desc));
    if (source == Source::surfels) total += SurfelInput::estimateBytes(shape.surfels, shape.uploads);
    if (source == Source::screen) total += ScreenSurfels::estimateBytes(shape);
    return total;
}

}  // namespace lightwell
