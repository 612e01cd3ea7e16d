#include "techniques/screen_view.h"

#include <cstring>
#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kLightNeeds = kNeedsDirectRadiance | kNeedsReceiveMask;
constexpr std::size_t kCountBytes = 2 * sizeof(cl_int);

PyramidOptions pyramidOptions(const ScreenOptions& options, bool light) {
    PyramidOptions pyramid;
    pyramid.extras = options.extras | (light ? kPyramidRadiance : 0u);
    pyramid.firstLevel = options.half ? 1 : 0;
    pyramid.sampled = true;
    pyramid.lastLevel = pyramid.firstLevel + options.levels - 1;
    return pyramid;
}

Planes part(const Planes& image, std::uint32_t first, std::uint32_t count) {
    Planes planes = image;
    planes.offset += first * planes.planeStride;
    planes.count = count;
    return planes;
}

std::uint32_t needsOf(const ScreenOptions& options, bool light) {
    return (light ? kLightNeeds : 0u) | (options.keeps() ? std::uint32_t(kNeedsMotion) : 0u);
}

ScreenPlanes partsOf(const Planes& five) { return {part(five, 0, 3), part(five, 3, 1), part(five, 4, 1)}; }

bool isAsked(const LWImage& image) { return rawEnum(image.format) != LW_FORMAT_NONE; }

}  // namespace

ScreenPasses::ScreenPasses(Device& device, const ScreenOptions& options)
    : withLight_(device, options.extras | kPyramidRadiance),
      plain_(device, options.extras),
      filterLight_(device, true),
      filterAmbient_(device, false) {
    if (options.keeps()) history_.emplace(device, options.history);
    if (!options.half) return;
    upsampleAll_.emplace(device, 5);
    upsampleOne_.emplace(device, 1);
}

ScreenView::ScreenView(Device& device, const ScreenOptions& options)
    : device_(device),
      options_(options),
      counts_(device, kCountBytes, "counts of a view"),
      upsampleCounts_(device, kCountBytes, "counts of a view") {}

void ScreenView::check(Device& device, const View& view, const LWOutput& output, const char* technique) {
    checkLightOutputs(device, view, output, technique, kMakesAmbient);
}

// Memory of what this frame needs, for the view's largest size.
void ScreenView::reserve(const View& view) {
    const std::uint32_t w = options_.gathered(view.maxWidth), h = options_.gathered(view.maxHeight);
    PyramidLevels& levels = wantsLight_ ? withLight_ : plain_;
    if (!levels.bytes()) levels = PyramidLevels(device_, view.maxWidth, view.maxHeight, pyramidOptions(options_, wantsLight_));
    if (wantsLight_ && !light_) light_ = PlanarImage(device_, w, h, WeightedFilter::planes(true), "gathered light");
    if (!ambient_) ambient_ = PlanarImage(device_, w, h, WeightedFilter::planes(false), "gathered ambient occlusion");
    if (options_.rows > 1 && between_.planes(w, h).count < WeightedFilter::planes(wantsLight_))
        between_ = PlanarImage(device_, w, h, WeightedFilter::planes(wantsLight_), "sums of the filter's columns");
    if (options_.keeps() && !history_) {
        history_.emplace(device_, options_.history, view.maxWidth, view.maxHeight);
        current_ = PlanarImage(device_, view.maxWidth, view.maxHeight, 5, "light of a frame alone");
        kept_ = PlanarImage(device_, view.maxWidth, view.maxHeight, 5, "means not asked for");
    }
    if (!options_.half) return;
    if (wantsLight_ && !filteredLight_) filteredLight_ = PlanarImage(device_, w, h, 5, "filtered light");
    if (!filteredAmbient_) filteredAmbient_ = PlanarImage(device_, w, h, 1, "filtered ambient occlusion");
}

void ScreenView::begin(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                       const Camera& camera, ScreenPasses& passes, std::uint32_t turn) {
    const bool light = isAsked(output.irradiance) || isAsked(output.validity);
    gbuffer_.import(executor, view, gbuffer, needsOf(options_, light), "gbuffer");
    wantsLight_ = light;
    hasLight_ = false;  // should a later step fail, the images of the frame before are gone
    isRendered_ = true;
    width_ = options_.gathered(view.width);
    height_ = options_.gathered(view.height);
    reserve(view);
    if (history_) beginPicture(executor, view, gbuffer.camera);
    executor.fill("screen_view.counts", counts_, 0, 0, counts_.bytes());
    executor.fill("screen_view.counts", upsampleCounts_, 0, 0, upsampleCounts_.bytes());
    asked_.irradiance = irradianceTarget_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    asked_.validity = validityTarget_.begin(executor, view, output.validity, 1, "output.validity");
    asked_.open = ambientTarget_.begin(executor, view, output.ambientOcclusion, 1, "output.ambientOcclusion");
    made_ = options_.keeps() ? partsOf(current_.planes(view.width, view.height)) : asked_;
    (light ? passes.withLight_ : passes.plain_)
        .record(executor, gbuffer_.position, gbuffer_.normal, gbuffer_.directRadiance, gbuffer_.receiveMask, camera,
                light ? withLight_ : plain_, counts_, turn);
}

// The same picture may be rendered for one output after another: what was made of it first still holds.
void ScreenView::beginPicture(Executor& executor, const View& view, const LWCamera& camera) {
    const bool isSized = view.width == fullWidth_ && view.height == fullHeight_;
    if (isBegun_ && isSized && std::memcmp(&camera_, &camera, sizeof camera) == 0) return;
    // What is not made enters the history as it was last made: of another size it would be noise, and much later a change of light
    // that also shortens the means of what is made.
    if (!isSized || (hasOldLight_ && !wantsLight_ && !held_.light)) {
        executor.fill("screen_view.clear", current_.buffer(), 0, 0, current_.bytes());
        hasOldLight_ = false;
    }
    fresh_ = {};
    heldBefore_ = held_;
    isBegun_ = true;
    fullWidth_ = view.width;
    fullHeight_ = view.height;
    camera_ = camera;
}

Planes ScreenView::sized(const PlanarImage& image) const { return image.planes(width_, height_); }

Planes ScreenView::between(bool light) const { return between_ ? part(sized(between_), 0, WeightedFilter::planes(light)) : Planes{}; }

Planes ScreenView::gathered(bool light) const { return sized(light ? light_ : ambient_); }

void ScreenView::finishLight(Executor& executor, ScreenPasses& passes, bool withAmbient) {
    const std::uint32_t base = levels().options().firstLevel;
    const Planes position = levels().position(base), normal = levels().normal(base), open = withAmbient ? made_.open : Planes{};
    hasLight_ = true;
    fresh_.light = hasOldLight_ = true;
    fresh_.open = fresh_.open || withAmbient;
    if (!options_.half) {
        passes.filterLight_.record(executor, position, normal, options_.columns, options_.rows, gathered(true), between(true),
                                   made_.irradiance, made_.validity, open);
        return;
    }
    const Planes filtered = sized(filteredLight_);
    passes.filterLight_.record(executor, position, normal, options_.columns, options_.rows, gathered(true), between(true),
                               part(filtered, 0, 3), part(filtered, 3, 1), part(filtered, 4, 1));
    passes.upsampleAll_->recordUpsampleAll(executor, gbuffer_.position, gbuffer_.normal, position, normal, filtered,
                                           made_.irradiance, made_.validity, open, upsampleCounts_);
}

void ScreenView::finishAmbient(Executor& executor, ScreenPasses& passes) {
    const std::uint32_t base = levels().options().firstLevel;
    const Planes position = levels().position(base), normal = levels().normal(base);
    const Planes filtered = options_.half ? sized(filteredAmbient_) : made_.open;
    fresh_.open = true;
    passes.filterAmbient_.record(executor, position, normal, options_.columns, options_.rows, gathered(false),
                                 between(false), {}, {}, filtered);
    if (options_.half)
        passes.upsampleOne_->recordUpsample(executor, gbuffer_.position, gbuffer_.normal, position, normal, filtered, made_.open,
                                            upsampleCounts_);
}

void ScreenView::record(Executor& executor, ScreenPasses& passes) {
    const Planes& size = gbuffer_.position;
    const ScreenPlanes kept = partsOf(kept_.planes(size.width, size.height));
    const auto to = [](const Planes& asked, const Planes& spare) { return asked ? asked : spare; };
    // A mean of what was not made before is none.
    if ((fresh_.light && !heldBefore_.light) || (fresh_.open && !heldBefore_.open)) history_->forget();
    passes.history_->record(executor,
                            {gbuffer_.position, gbuffer_.normal, gbuffer_.motion, current_.planes(size.width, size.height),
                             to(asked_.irradiance, kept.irradiance), to(asked_.validity, kept.validity), to(asked_.open, kept.open)},
                            camera_, *history_);
    held_ = fresh_;
}

void ScreenView::end(Executor& executor, ScreenPasses& passes) {
    if (history_) record(executor, passes);
    irradianceTarget_.end(executor);
    validityTarget_.end(executor);
    ambientTarget_.end(executor);
}

void ScreenView::startFrame(bool forget) {
    isRendered_ = isBegun_ = false;
    if (history_) history_->startFrame(forget);
}

void ScreenView::startReport(const ScreenOptions& options, Report& report) {
    if (options.keeps()) report.counts.push_back({"history_new", 0});
    for (const char* name : {"rejected_pixels", "rejected_radiances", "upsample_fallbacks"}) report.counts.push_back({name, 0});
}

void ScreenView::report(Device& device, Report& report) const {
    if (!isRendered_) return;
    gbuffer_.report(report);
    irradianceTarget_.report(report);
    validityTarget_.report(report);
    ambientTarget_.report(report);
    report.read(device, "rejected_pixels", counts_, 0);
    report.read(device, "rejected_radiances", counts_, sizeof(cl_int));
    report.read(device, "upsample_fallbacks", upsampleCounts_, sizeof(cl_int));
    if (history_) history_->report(device, report);
}

void ScreenView::addDebugViews(ScreenPasses& passes, std::vector<DebugView>& views) const {
    if (history_)
        if (const Planes shape = passes.history_->ageShape(*history_); shape.width)
            views.push_back({"history_age", "frames in each pixel's mean; 1: new in this frame, 0: no surface", shape,
                             [this, &passes](Executor& executor, const Planes& planes) { passes.history_->recordAge(executor, *history_, planes); }});
    if (!hasLight_) return;
    views.push_back({"position", "world position of the gathered pixels (m)", levels().position(levels().options().firstLevel), {}});
    views.push_back({"gathered", "before the filter, times the weight: radiance rgb (W/(sr m^2)), seen share, open share; weight",
                     gathered(true), {}});
    if (options_.half)
        views.push_back({"filtered", "irradiance rgb (W/m^2), validity, ambient occlusion", sized(filteredLight_), {}});
}

std::uint64_t ScreenView::bytes() const {
    return gbuffer_.bytes() + irradianceTarget_.bytes() + validityTarget_.bytes() + ambientTarget_.bytes() +
           withLight_.bytes() + plain_.bytes() + light_.bytes() + ambient_.bytes() + filteredLight_.bytes() +
           filteredAmbient_.bytes() + between_.bytes() + current_.bytes() + kept_.bytes() +
           (history_ ? history_->bytes() : 0) + counts_.bytes() + upsampleCounts_.bytes();
}

std::uint64_t ScreenView::estimateBytes(const ScreenOptions& options, const LWViewDesc& view, bool uploads) {
    std::uint64_t total = GBufferInput::estimateBytes(view, needsOf(options, true), uploads) + 2 * kCountBytes +
                          OutputTarget::estimateBytes(view, 3, uploads) + 2 * OutputTarget::estimateBytes(view, 1, uploads);
    for (const bool light : {true, false})
        total += PyramidLevels::estimateBytes(view.maxWidth, view.maxHeight, pyramidOptions(options, light));
    const std::uint64_t planes = WeightedFilter::planes(true) + WeightedFilter::planes(false) + (options.half ? 5 + 1 : 0) +
                                 (options.rows > 1 ? WeightedFilter::planes(true) : 0);
    if (options.keeps())
        total += ViewHistory::estimateBytes(options.history, view.maxWidth, view.maxHeight) +
                 10 * sizeof(float) * std::uint64_t(paddedWidth(view.maxWidth)) * view.maxHeight;
    return total + planes * sizeof(float) * paddedWidth(options.gathered(view.maxWidth)) * options.gathered(view.maxHeight);
}

std::vector<LWChoice> unusedByScreen(const LWFrame& frame) {
    constexpr const char* kReason = "not used: this technique takes light from the view's own pixels only";
    std::vector<LWChoice> unused;
    if (frame.sourceViewCount) unused.push_back({"frame.sourceViews", kReason});
    if (frame.geometry) unused.push_back({"frame.geometry", kReason});
    if (frame.blockerCount) unused.push_back({"frame.blockers", kReason});
    if (frame.lightCount) unused.push_back({"frame.lights", kReason});
    if (frame.vplCount) unused.push_back({"frame.vpls", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    return unused;
}

}  // namespace lightwell
