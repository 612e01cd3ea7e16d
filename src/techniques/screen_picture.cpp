#include "techniques/screen_picture.h"

#include "compute/device.h"
#include "passes/screen_pattern.h"

namespace lightwell {
namespace {

std::uint64_t patternBytes(const ScreenSpaceOptions& options) {
    return std::uint64_t(options.interleave) * options.interleave * options.samples * sizeof(LwScreenSample);
}

constexpr const char* kLevelNames[] = {"level1", "level2", "level3", "level4", "level5", "level6"};

}  // namespace

ScreenPicture::ScreenPicture(Device& device, const ScreenSpaceOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : device_(device),
      options_(options),
      maxWidth_(maxWidth),
      maxHeight_(maxHeight),
      pyramid_(device, maxWidth, maxHeight, options.pyramid()),
      levels_(device, maxWidth, maxHeight, options.range(), options.interleave),
      counts_(device, LW_SCREEN_COUNTERS * sizeof(cl_int), "counts of a view") {
    for (Buffer& patterns : patterns_) patterns = Buffer(device, std::size_t(patternBytes(options)), "sample patterns");
}

void ScreenPicture::check(Device& device, const ScreenSpaceOptions& options, const View& view, const LWGBuffer& gbuffer, const std::string& name) {
    GBufferInput::check(device, view, gbuffer, options.needs(), name.c_str());
    const Camera camera(gbuffer.camera, view.width, view.height, name + ".camera");
}

// The first level's disc and the ring of all others, in texels of the level.
void ScreenPicture::makePatterns(Executor& executor, std::uint32_t rows, std::uint32_t turn) {
    const bool isNew = rows != patternRows_;
    if (!isNew && (turn == patternTurn_ || (alike_[0] && alike_[1]))) return;
    const double r = options_.radiusAt(rows);
    const std::vector<LwScreenSample> tables[2] = {
        screenPatterns(0.0, 2.0 * r, options_.samples, options_.interleave, options_.seed, turn),
        screenPatterns(r, 2.0 * r, options_.samples, options_.interleave, options_.seed, turn)};
    if (isNew) {
        alike_[0] = takesEveryTexel(0.0, 2.0 * r, options_.samples);
        alike_[1] = takesEveryTexel(r, 2.0 * r, options_.samples);
    }
    for (int i = 0; i < 2; ++i)
        executor.writeCopy("screen_gather.patterns", patterns_[i], 0, tables[i].size() * sizeof(LwScreenSample), tables[i].data());
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
    gatherLevels(executor, passes);
}

// Coarse to fine; the coarsest level's light is its own alone.
void ScreenPicture::gatherLevels(Executor& executor, ScreenSpacePasses& passes) {
    const LevelRange range = options_.range();
    const bool filters = options_.interleave > 1;
    std::vector<Planes> contributions(options_.levels);
    Planes sum;
    for (std::uint32_t k = range.last + 1; k-- > range.first;) {
        passes.gather.recordDeal(executor, pyramid_, levels_, k);
        const Planes raw = filters ? levels_.other(k) : levels_.own(k), own = levels_.own(k), texels = pyramid_.level(k);
        const int table = k == range.first ? 0 : 1;
        passes.gather.recordGather(executor, levels_, k, patterns_[table], options_.samples, options_.bounded, raw);
        if (filters) passes.combine.recordFilter(executor, texels, alike_[table], raw, own);
        contributions[k - range.first] = own;
        if (k < range.last) passes.combine.recordAdd(executor, texels, own, pyramid_.level(k + 1), sum, levels_.other(k));
        sum = k < range.last ? levels_.other(k) : own;
    }
    contributions_ = std::move(contributions);
    lit_ = sum;
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
}

void ScreenPicture::addDebugViews(std::vector<DebugView>& views) const {
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
    views.push_back({"gathered", "all levels together, at the first one's resolution: irradiance rgb (W/m^2), share seen", lit_, {}});
}

std::uint64_t ScreenPicture::bytes() const {
    return gbuffer_.bytes() + pyramid_.bytes() + levels_.bytes() + counts_.bytes() + patterns_[0].bytes() + patterns_[1].bytes();
}

std::uint64_t ScreenPicture::estimateBytes(const ScreenSpaceOptions& options, const LWViewDesc& view, bool uploads) {
    return GBufferInput::estimateBytes(view, options.needs(), uploads) +
           PyramidLevels::estimateBytes(view.maxWidth, view.maxHeight, options.pyramid()) +
           ScreenLevels::estimateBytes(view.maxWidth, view.maxHeight, options.range(), options.interleave) +
           2 * patternBytes(options) + LW_SCREEN_COUNTERS * sizeof(cl_int);
}

}  // namespace lightwell
