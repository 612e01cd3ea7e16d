#include "techniques/interleaved_view.h"

#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "shared/pixel_repair_types.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = 4 * sizeof(cl_int);

constexpr const char* kSkips = "VPLs that cannot light a tile of pixels are skipped there";
constexpr const char* kSkipsNone = "none: a list of more than 16384 slots, of which every pixel takes its whole share";
static_assert(VplTiles::kMostSlots == 16384, "kSkipsNone names it");

// Of what a debug view draws when it is asked for.
Planes shapeOf(std::uint32_t width, std::uint32_t height, std::uint32_t planes) {
    Planes shape;
    shape.width = width;
    shape.height = height;
    shape.rowStride = paddedWidth(width);
    shape.planeStride = shape.rowStride * height;
    shape.count = planes;
    return shape;
}

std::uint32_t needsOf(const InterleavedOptions& options) {
    return (options.compensated ? std::uint32_t(kNeedsDirectRadiance) : 0u) |
           (options.keeps() ? std::uint32_t(kNeedsMotion) : 0u);
}

}  // namespace

InterleavedView::InterleavedView(Device& device, const InterleavedOptions& options, const View& view)
    : device_(device),
      options_(options),
      gatheredWidth_(options.gathered(view.maxWidth)),
      gatheredHeight_(options.gathered(view.maxHeight)),
      counts_(device, kCountBytes, "counts of a view") {
    const std::uint32_t width = gatheredWidth_, height = gatheredHeight_;
    if (options.halvings || options.filters() || options.keeps()) gathered_ = PlanarImage(device, width, height, options.gatheredPlanes(), "gathered irradiance");
    if (options.halvings && options.filters()) filtered_ = PlanarImage(device, width, height, 3, "filtered irradiance");
    for (std::uint32_t l = 1; l <= options.halvings; ++l) {
        const std::uint32_t w = JointBilateral::halved(view.maxWidth, l), h = JointBilateral::halved(view.maxHeight, l);
        Level& level = levels_.emplace_back();
        level.position = PlanarImage(device, w, h, 3, "positions of fewer pixels");
        level.normal = PlanarImage(device, w, h, 3, "normals of fewer pixels");
        if (l < options.halvings) level.light = PlanarImage(device, w, h, 3, "irradiance of fewer pixels");
        if (options.compensated) level.radiance = PlanarImage(device, w, h, 3, "direct radiance of fewer pixels");
    }
    if (options.compensated) senders_.reserve(device, width, height, options.interleave);
    if (options.repairs > 0.0f) {
        repaired_.emplace(device, view.maxWidth, view.maxHeight);
        repairRows_ = RepairedPixels::listedRows(view.maxWidth, view.maxHeight);
    }
    if (!options.keeps()) return;
    if (options.halvings || options.filters()) current_ = PlanarImage(device, view.maxWidth, view.maxHeight, 3, "irradiance of a frame alone");
    history_.emplace(device, options.history, view.maxWidth, view.maxHeight);
}

void InterleavedView::startFrame(bool forget) {
    isRendered_ = false;
    if (history_) history_->startFrame(forget);
}

void InterleavedView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                             const Passes& passes, const Gather& gather, const Gather& gatherAll) {
    if (history_) TemporalHistory::checkCamera(gbuffer, view.width, view.height);
    gbuffer_.import(executor, view, gbuffer, needsOf(options_), "gbuffer");
    // Should a later step fail, the images of the frame before are gone.
    lastGathered_ = lastFiltered_ = compensatedPosition_ = compensatedNormal_ = Planes{};
    isRendered_ = true;
    const Planes irradiance = irradiance_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    const Planes validity = validity_.begin(executor, view, output.validity, 1, "output.validity");
    if (irradiance) light(executor, passes, gbuffer.camera, irradiance, validity, gather, gatherAll);
    if (validity && !(irradiance && lastMakesValidity())) passes.gather.recordValidity(executor, gbuffer_.position, gbuffer_.normal, validity);
    irradiance_.end(executor);
    validity_.end(executor);
}

void InterleavedView::light(Executor& executor, const Passes& passes, const LWCamera& camera, const Planes& irradiance,
                            const Planes& validity, const Gather& gather, const Gather& gatherAll) {
    const bool reduced = options_.halvings > 0, filter = options_.filters();
    executor.fill("interleaved_gather.counts", counts_, 0, 0, counts_.bytes());
    downsample(executor, passes.bilateral);
    const auto [position, normal] = surfaces_.back();
    // The last of what follows writes to the host; the history, where there is one, after it.
    const Planes made = !history_ ? irradiance : (reduced || filter ? current_ : gathered_).planes(irradiance.width, irradiance.height);
    const Planes gathered = reduced || filter ? gathered_.planes(position.width, position.height) : made;
    gather(position, normal, gathered);
    Planes lit = gathered;
    if (filter) {
        lit = reduced ? filtered_.planes(position.width, position.height) : made;
        passes.gather.recordFilter(executor, position, normal, gathered, lit, filtersLast() ? validity : Planes{});
    }
    if (reduced) upsample(executor, passes, lit, made, validity, gatherAll);
    if (history_)
        passes.history->record(executor, {gbuffer_.position, gbuffer_.normal, gbuffer_.motion, made, irradiance, {}, {}}, camera, *history_);
    lastGathered_ = gathered;
    lastGathered_.count = 3;
    lastFiltered_ = lit;
}

// Halves of halves: each level's surfaces are some of the one before, which it is up-sampled by.
void InterleavedView::downsample(Executor& executor, JointBilateral* bilateral) {
    surfaces_.assign(1, {gbuffer_.position, gbuffer_.normal});
    for (const Level& level : levels_) {
        const Surfaces fine = surfaces_.back();
        const std::uint32_t w = JointBilateral::halved(fine.position.width), h = JointBilateral::halved(fine.position.height);
        surfaces_.push_back({level.position.planes(w, h), level.normal.planes(w, h)});
        bilateral->recordDownsample(executor, fine.position, fine.normal, surfaces_.back().position, surfaces_.back().normal);
    }
}

// lit: of the coarsest level.
void InterleavedView::upsample(Executor& executor, const Passes& passes, Planes lit, const Planes& made, const Planes& validity,
                               const Gather& gatherAll) {
    for (std::size_t l = levels_.size(); l > 1; --l) {
        const Surfaces &coarse = surfaces_[l], &fine = surfaces_[l - 1];
        const Planes light = levels_[l - 2].light.planes(fine.position.width, fine.position.height);
        passes.bilateral->recordUpsample(executor, fine.position, fine.normal, coarse.position, coarse.normal, lit, light, counts_);
        lit = light;
    }
    const auto [position, normal] = surfaces_[0];
    const auto [halfPosition, halfNormal] = surfaces_[1];
    if (!repaired_) return passes.bilateral->recordUpsample(executor, position, normal, halfPosition, halfNormal, lit, made, counts_, validity);
    const std::uint32_t w = made.width, h = made.height;
    passes.bilateral->recordUpsampleMarked(executor, position, normal, halfPosition, halfNormal, lit, made, options_.repairs,
                                           repaired_->marks(), validity, counts_);
    passes.repair->recordCollect(executor, position, normal, *repaired_);
    gatherAll(repaired_->position(w, h), repaired_->normal(w, h), repaired_->light(w, h));
    passes.repair->recordPut(executor, *repaired_, made);
}

const Buffer& InterleavedView::cullAll(Executor& executor, InterleavedGather& passes, const Planes& position, const Planes& normal,
                                       const Buffer& vpls, lw_subset_order order) {
    repairTiles_.reserve(device_, LW_REPAIR_COLUMNS, repairRows_, order, 1);
    passes.recordCull(executor, position, normal, vpls, order, repairTiles_);
    return repairTiles_.masks();
}

const Buffer& InterleavedView::cull(Executor& executor, InterleavedGather& passes, const Planes& position,
                                    const Planes& normal, const Buffer& vpls, lw_subset_order order) {
    tiles_.reserve(device_, gatheredWidth_, gatheredHeight_, order, options_.interleave);
    passes.recordCull(executor, position, normal, vpls, order, tiles_);
    return tiles_.masks();
}

void InterleavedView::compensate(Executor& executor, BoundingCompensation& pass, const LWCamera& camera, const Planes& irradiance) {
    Planes radiance = gbuffer_.directRadiance;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Surfaces &fine = surfaces_[l], &coarse = surfaces_[l + 1];
        const Planes halved = levels_[l].radiance.planes(coarse.position.width, coarse.position.height);
        pass.recordHalve(executor, fine.position, fine.normal, radiance, coarse.position, coarse.normal, halved);
        radiance = halved;
    }
    const auto [position, normal] = surfaces_.back();
    const lw_pixel_area area = BoundingCompensation::pixelArea(camera, position.width, position.height, "gbuffer.camera");
    pass.recordSenders(executor, position, normal, radiance, area, senders_, counts_);
    pass.recordGather(executor, position, normal, senders_, false, irradiance, counts_);
    compensatedPosition_ = position;
    compensatedNormal_ = normal;
}

void InterleavedView::addCompensationView(BoundingCompensation& pass, std::vector<DebugView>& views) const {
    if (!compensatedPosition_) return;
    const Planes shape = shapeOf(compensatedPosition_.width, compensatedPosition_.height, 3);
    views.push_back({"compensation", "irradiance that compensates for the bounds of VPLs, before the filter (W/m^2)", shape,
                     [this, &pass](Executor& executor, const Planes& planes) {
                         pass.recordGather(executor, compensatedPosition_, compensatedNormal_, senders_, true, planes, counts_);
                     }});
}

void InterleavedView::report(Device& device, Report& report, lw_subset_order order) const {
    if (!isRendered_) return;
    gbuffer_.report(report);
    irradiance_.report(report);
    validity_.report(report);
    if (!lastGathered_) return;
    report.choose("tiles", VplTiles::skips(order) ? kSkips : kSkipsNone);
    report.read(device, "rejected_pixels", counts_, 0);
    report.read(device, "upsample_fallbacks", counts_, sizeof(cl_int));
    report.read(device, "saturated_pixels", counts_, 2 * sizeof(cl_int));
    if (repaired_) repaired_->report(device, report);
    if (history_) history_->report(device, report);
    if (options_.compensated) report.read(device, "compensation_capped", counts_, 3 * sizeof(cl_int));
}

void InterleavedView::addDebugViews(std::vector<DebugView>& views, TemporalHistory* history, PixelRepair* repair) const {
    if (!lastGathered_) return;
    views.push_back({"position", "world position (m)", gbuffer_.position, {}});
    views.push_back({"normal", "world normal as the host gave it", gbuffer_.normal, {}});
    views.push_back({"gathered", "irradiance before the filter (W/m^2), with what strict look-ups doubt, without what careful ones leave out", lastGathered_, {}});
    if (options_.filters()) views.push_back({"filtered", "irradiance after the filter (W/m^2)", lastFiltered_, {}});
    if (repaired_)
        views.push_back({"repair_marks", "1: a pixel that half resolution does not know the light of",
                         shapeOf(gbuffer_.position.width, gbuffer_.position.height, 1),
                         [this, repair](Executor& executor, const Planes& planes) { repair->recordMarks(executor, *repaired_, planes); }});
    if (!history_) return;
    if (const Planes shape = history->ageShape(*history_); shape.width)
        views.push_back({"history_age", "frames in each pixel's mean; 1: new in this frame, 0: no surface", shape,
                         [this, history](Executor& executor, const Planes& planes) { history->recordAge(executor, *history_, planes); }});
}

std::uint64_t InterleavedView::bytes() const {
    std::uint64_t levels = 0;
    for (const Level& level : levels_) levels += level.position.bytes() + level.normal.bytes() + level.light.bytes() + level.radiance.bytes();
    return levels + gbuffer_.bytes() + irradiance_.bytes() + validity_.bytes() + gathered_.bytes() + filtered_.bytes() +
           tiles_.bytes() + senders_.bytes() + counts_.bytes() + current_.bytes() + repairTiles_.bytes() + (repaired_ ? repaired_->bytes() : 0) +
           (history_ ? history_->bytes() : 0);
}

std::uint64_t InterleavedView::estimateBytes(const InterleavedOptions& options, const LWViewDesc& view, bool uploads,
                                             lw_subset_order order, lw_subset_order whole) {
    const std::uint32_t width = options.gathered(view.maxWidth), height = options.gathered(view.maxHeight);
    const bool keeps = options.keeps(), follows = options.halvings || options.filters();
    const std::uint64_t images = (follows || keeps ? 1u : 0u) + (options.halvings && options.filters() ? 1u : 0u);
    std::uint64_t levels = 0;
    for (std::uint32_t l = 1; l <= options.halvings; ++l)
        levels += ((options.compensated ? 3u : 2u) + (l < options.halvings ? 1u : 0u)) * 3 * sizeof(float) *
                  std::uint64_t(paddedWidth(JointBilateral::halved(view.maxWidth, l))) * JointBilateral::halved(view.maxHeight, l);
    const std::uint64_t history =
        !keeps ? 0
               : ViewHistory::estimateBytes(options.history, view.maxWidth, view.maxHeight) +
                     (follows ? 3 * sizeof(float) * std::uint64_t(paddedWidth(view.maxWidth)) * view.maxHeight : 0);
    const std::uint64_t senders =
        options.compensated ? CompensationSenders::estimateBytes(width, height, options.interleave) : 0;
    const std::uint64_t repairs =
        !(options.repairs > 0.0f)
            ? 0
            : RepairedPixels::estimateBytes(view.maxWidth, view.maxHeight) +
                  VplTiles::estimateBytes(LW_REPAIR_COLUMNS, RepairedPixels::listedRows(view.maxWidth, view.maxHeight), whole, 1);
    return history + senders + repairs + levels + GBufferInput::estimateBytes(view, needsOf(options), uploads) +
           OutputTarget::estimateBytes(view, 3, uploads) +
           OutputTarget::estimateBytes(view, 1, uploads) + kCountBytes +
           (images * 3 + (options.gatheredPlanes() - 3)) * paddedWidth(width) * height * sizeof(float) +
           VplTiles::estimateBytes(width, height, order, options.interleave);
}

}  // namespace lightwell
