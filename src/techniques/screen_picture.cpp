#include "techniques/screen_picture.h"

#include "compute/device.h"
#include "passes/screen_pattern.h"

namespace lightwell {
namespace {

std::uint32_t halvingsOf(const ScreenSpaceOptions& options) { return options.plans() ? ScreenPlanPass::halvings(options.samples) : 0; }

std::uint64_t patternBytes(const ScreenSpaceOptions& options) {
    std::uint64_t samples = 0;
    for (std::uint32_t i = 0; i <= halvingsOf(options); ++i) samples += options.samples >> i;
    return std::uint64_t(options.interleave) * options.interleave * samples * sizeof(LwScreenSample);
}

Planes part(const Planes& image, std::uint32_t first, std::uint32_t count) {
    Planes planes = image;
    planes.offset += first * planes.planeStride;
    planes.count = count;
    return planes;
}

// Of a picture whose pixels are texels of factor x factor: the last ones stick out, and clip coordinates x' = s (x + w) - w and
// y' = s (y - w) + w of the whole lie that much nearer its first corner.
LWCamera cameraOfTexels(const LWCamera& camera, const View& view, const Planes& texels, std::uint32_t factor) {
    const double s[2] = {double(view.width) / (double(texels.width) * factor), double(view.height) / (double(texels.height) * factor)};
    LWCamera result = camera;
    for (int column = 0; column < 4; ++column) {
        const double w = double(camera.projection[12 + column]);
        result.projection[column] = float(s[0] * (double(camera.projection[column]) + w) - w);
        result.projection[4 + column] = float(s[1] * (double(camera.projection[4 + column]) - w) + w);
    }
    return result;
}

// Borders without light, as up-sampling reads them.
std::uint64_t keptFloats(const ScreenSpaceOptions& options, std::uint32_t width, std::uint32_t height, std::vector<Planes>* planes) {
    return layOutLevels(width, height, {options.start, options.start}, LW_LIGHT_PLANES, 16, LW_PYRAMID_BORDER, planes);
}

constexpr const char* kLevelNames[] = {"level1", "level2", "level3", "level4", "level5", "level6"};

}  // namespace

ScreenPicture::History::History(Device& device, const ScreenSpaceOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : view(device, options.history, levelSize(maxWidth, options.start), levelSize(maxHeight, options.start)),
      motion(device, levelSize(maxWidth, options.start), levelSize(maxHeight, options.start), 2, "motion of texels"),
      memory(device, std::size_t(keptFloats(options, maxWidth, maxHeight, nullptr)) * sizeof(float), "light kept of the frames before") {}

ScreenPicture::ScreenPicture(Device& device, const ScreenSpaceOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : device_(device),
      options_(options),
      maxWidth_(maxWidth),
      maxHeight_(maxHeight),
      pyramid_(device, maxWidth, maxHeight, options.pyramid()),
      levels_(device, maxWidth, maxHeight, options.range(), options.interleave),
      counts_(device, LW_SCREEN_COUNTERS * sizeof(cl_int), "counts of a view") {
    if (options.plans()) plan_.emplace(device);
    if (options.keeps()) history_.emplace(device, options, maxWidth, maxHeight);
    for (Buffer& patterns : patterns_) patterns = Buffer(device, std::size_t(patternBytes(options)), "sample patterns");
}

void ScreenPicture::check(Device& device, const ScreenSpaceOptions& options, const View& view, const LWGBuffer& gbuffer, const std::string& name) {
    GBufferInput::check(device, view, gbuffer, options.needs(), name.c_str());
    const Camera camera(gbuffer.camera, view.width, view.height, name + ".camera");
}

// The first level's disc and the ring of all others, in texels of the level.
void ScreenPicture::makePatterns(Executor& executor, std::uint32_t rows, std::uint32_t turn) {
    const bool isNew = rows != patternRows_;
    std::uint32_t all = 0;
    for (std::uint32_t i = 0; i <= halvingsOf(options_); ++i) all += options_.samples >> i;
    if (!isNew && (turn == patternTurn_ || (alike_[0] == all && alike_[1] == all))) return;
    const double r = options_.radiusAt(rows), inner[2] = {0.0, r};
    for (int i = 0; i < 2; ++i) {
        std::vector<LwScreenSample> table;
        if (isNew) alike_[i] = 0;
        for (std::uint32_t halving = 0; halving <= halvingsOf(options_); ++halving) {
            const std::uint32_t samples = options_.samples >> halving;
            const std::vector<LwScreenSample> patterns = screenPatterns(inner[i], 2.0 * r, samples, options_.interleave, options_.seed, turn);
            table.insert(table.end(), patterns.begin(), patterns.end());
            if (isNew && takesEveryTexel(inner[i], 2.0 * r, samples)) alike_[i] |= samples;
        }
        executor.writeCopy("screen_gather.patterns", patterns_[i], 0, table.size() * sizeof(LwScreenSample), table.data());
    }
    patternRows_ = rows;
    patternTurn_ = turn;
}

void ScreenPicture::light(Executor& executor, ScreenSpacePasses& passes, const View& view, const LWGBuffer& gbuffer,
                          const std::string& name, std::uint32_t turn) {
    const Camera camera(gbuffer.camera, view.width, view.height, name + ".camera");
    gbuffer_.import(executor, view, gbuffer, options_.needs(), name.c_str());
    camera_ = camera;
    // Should a later step fail, the images of the frame before are gone.
    contributions_.clear();
    lit_ = Planes{};
    isLit_ = true;
    executor.fill("screen_gather.counts", counts_, 0, 0, counts_.bytes());
    makePatterns(executor, view.height, turn);
    levels_.resize(executor, view.width, view.height);
    passes.pyramid.record(executor, gbuffer_.position, gbuffer_.normal, gbuffer_.directRadiance, gbuffer_.receiveMask, camera_,
                          pyramid_, counts_);
    if (plan_) plan_->record(executor, *passes.plan, pyramid_, options_.radiusAt(view.height), alike_[0], alike_[1]);
    gatherLevels(executor, passes);
    if (history_) keep(executor, passes, view, gbuffer.camera);
}

// Coarse to fine; the coarsest level's light is its own alone.
void ScreenPicture::gatherLevels(Executor& executor, ScreenSpacePasses& passes) {
    const LevelRange range = options_.range();
    const bool filters = options_.interleave > 1;
    std::vector<Planes> contributions(options_.levels);
    Planes sum;
    for (std::uint32_t k = range.last + 1; k-- > range.first;) {
        const Buffer* plan = plan_ ? &plan_->plan() : nullptr;
        passes.gather.recordDeal(executor, pyramid_, levels_, k, plan);
        const Planes raw = filters ? levels_.other(k) : levels_.own(k), own = levels_.own(k), texels = pyramid_.level(k);
        const int table = k == range.first ? 0 : 1;
        if (plan) {
            passes.gather.recordGather(executor, levels_, k, patterns_[1], patterns_[0], options_.samples, options_.bounded, raw, *plan);
            if (filters) passes.combine.recordFilter(executor, texels, alike_[1], alike_[0], raw, own, *plan, k - range.first);
        } else {
            passes.gather.recordGather(executor, levels_, k, patterns_[table], options_.samples, options_.bounded, raw);
            if (filters) passes.combine.recordFilter(executor, texels, alike_[table] != 0, raw, own);
        }
        contributions[k - range.first] = own;
        if (k < range.last) passes.combine.recordAdd(executor, texels, own, pyramid_.level(k + 1), sum, levels_.other(k));
        sum = k < range.last ? levels_.other(k) : own;
    }
    contributions_ = std::move(contributions);
    lit_ = sum;
}

// At the first level's resolution: light is as fine as that, and a history of the host's pixels takes longer than all the rest.
void ScreenPicture::keep(Executor& executor, ScreenSpacePasses& passes, const View& view, const LWCamera& camera) {
    const std::uint32_t start = options_.start;
    const Planes texels = pyramid_.level(start);
    Planes motion = gbuffer_.motion;
    if (motion && start > 0) {
        motion = history_->motion.planes(texels.width, texels.height);
        passes.combine.recordMotion(executor, gbuffer_.position, gbuffer_.motion, texels, motion);
    }
    Planes& kept = history_->light;
    if (kept.width != texels.width || kept.height != texels.height) {
        std::vector<Planes> planes;
        keptFloats(options_, view.width, view.height, &planes);
        kept = planes.front();
        kept.memory = history_->memory.get();
        executor.fill("screen_gather.clear", history_->memory, 0, 0, history_->memory.bytes());
    }
    passes.history->record(executor, {pyramid_.position(start), pyramid_.normal(start), motion, lit_, kept, part(kept, LW_LIGHT_SHARE, 1), {}},
                           cameraOfTexels(camera, view, texels, 1u << start), history_->view);
    lit_ = kept;
}

void ScreenPicture::finish(Executor& executor, ScreenSpacePasses& passes, const Planes& irradiance, const Planes& validity) {
    passes.combine.recordFinish(executor, gbuffer_.position, gbuffer_.normal, pyramid_.level(options_.start), lit_, irradiance,
                                validity, counts_);
}

void ScreenPicture::join(Executor& executor, ScreenSpacePasses& passes, const ScreenPicture& other, const Planes& irradiance,
                      const Planes& validity) {
    passes.combine.recordJoin(executor, gbuffer_.position, gbuffer_.normal, other.pyramid_.level(options_.start), other.camera_,
                              other.lit_, irradiance, validity);
}

void ScreenPicture::report(Device& device, Report& report) const {
    if (!isLit_) return;
    gbuffer_.report(report);
    report.read(device, "rejected_pixels", counts_, LW_SCREEN_REJECTED_PIXELS * sizeof(cl_int));
    report.read(device, "rejected_radiances", counts_, LW_SCREEN_REJECTED_RADIANCE * sizeof(cl_int));
    report.read(device, "upsample_fallbacks", counts_, LW_SCREEN_FALLBACKS * sizeof(cl_int));
    report.read(device, "saturated_pixels", counts_, LW_SCREEN_SATURATED * sizeof(cl_int));
    if (plan_) plan_->report(device, report);
    if (history_) history_->view.report(device, report);
}

void ScreenPicture::addDebugViews(std::vector<DebugView>& views, ScreenSpacePasses& passes) const {
    if (!lit_) return;
    views.push_back({"position", "world position (m)", gbuffer_.position, {}});
    views.push_back({"normal", "world normal as the host gave it", gbuffer_.normal, {}});
    views.push_back({"start_position", "world position of the first level's texels (m)", pyramid_.position(options_.start), {}});
    views.push_back({"start_normal", "their unit normals", pyramid_.normal(options_.start), {}});
    views.push_back({"start_radiance", "direct radiance averaged over each (W/(sr m^2))", pyramid_.radiance(options_.start), {}});
    views.push_back({"start_area", "area of the surface that each shows (m^2); negative: only receives", pyramid_.area(options_.start), {}});
    for (std::size_t i = 0; i < contributions_.size(); ++i)
        views.push_back({kLevelNames[i], "what the level gathers: irradiance rgb (W/m^2), share of the hemisphere seen",
                         contributions_[i], {}});
    views.push_back({"gathered", "all levels together, at the first one's resolution, and their history: irradiance rgb (W/m^2), share seen", lit_, {}});
    if (!history_) return;
    if (const Planes shape = passes.history->ageShape(history_->view); shape.width)
        views.push_back({"history_age", "frames in each texel's mean; 1: new in this frame, 0: no surface", shape,
                         [this, &passes](Executor& executor, const Planes& planes) { passes.history->recordAge(executor, history_->view, planes); }});
}

std::uint64_t ScreenPicture::bytes() const {
    return gbuffer_.bytes() + pyramid_.bytes() + levels_.bytes() + counts_.bytes() + patterns_[0].bytes() + patterns_[1].bytes() +
           (plan_ ? plan_->bytes() : 0) +
           (history_ ? history_->view.bytes() + history_->motion.bytes() + history_->memory.bytes() : 0);
}

std::uint64_t ScreenPicture::estimateBytes(const ScreenSpaceOptions& options, const LWViewDesc& view, bool uploads) {
    const std::uint32_t width = levelSize(view.maxWidth, options.start), height = levelSize(view.maxHeight, options.start);
    const std::uint64_t history = !options.keeps() ? 0
                                                   : ViewHistory::estimateBytes(options.history, width, height) +
                                                         sizeof(float) * (2 * std::uint64_t(paddedWidth(width)) * height +
                                                                          keptFloats(options, view.maxWidth, view.maxHeight, nullptr));
    return history + GBufferInput::estimateBytes(view, options.needs(), uploads) +
           PyramidLevels::estimateBytes(view.maxWidth, view.maxHeight, options.pyramid()) +
           ScreenLevels::estimateBytes(view.maxWidth, view.maxHeight, options.range(), options.interleave) +
           2 * patternBytes(options) + (options.plans() ? ScreenPlan::estimateBytes() : 0) + LW_SCREEN_COUNTERS * sizeof(cl_int);
}

}  // namespace lightwell
