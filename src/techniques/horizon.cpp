// Frame part, report and registration; the table of parameters is horizon_parameters.cpp's.
#include "techniques/horizon.h"

#include <numeric>

#include "compute/device.h"
#include "passes/horizon_gather.h"
#include "techniques/horizon_parameters.h"
#include "techniques/prewarm.h"
#include "techniques/screen_view.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

bool isHalf(const LWHorizonDesc& desc) { return desc.resolution == LW_RESOLUTION_HALF; }

// Each row of pixels takes as many slices as the next.
std::uint32_t rowsOf(const LWHorizonDesc& desc) { return std::gcd(desc.directions, desc.interleave); }

HorizonPatternOptions patternOf(const LWHorizonDesc& desc) { return {desc.directions, desc.steps, rowsOf(desc)}; }

// Of an image that is so many pixels high; in gathered ones.
double reachPixels(const LWHorizonDesc& desc, std::uint32_t height) {
    return double(desc.reach) * (isHalf(desc) ? JointBilateral::halved(height) : height);
}

ScreenOptions screenOptions(const LWHorizonDesc& desc, std::uint32_t maxHeight) {
    ScreenOptions options;
    options.half = isHalf(desc);
    options.rows = desc.filter ? rowsOf(desc) : 1;
    options.columns = desc.filter ? 8 : 1;  // of the shifts on coarse levels
    options.history = {desc.history, desc.historyClamp, 2};
    options.levels = horizonLevels(desc.steps, reachPixels(desc, maxHeight));
    return options;
}

struct HorizonView {
    ScreenView screen;
    HorizonTables withLight, plain;  // the two pyramids lie differently
};

class HorizonTechnique final : public Technique {
public:
    HorizonTechnique(Device& device, const LWHorizonDesc& desc)
        : device_(device),
          desc_(desc),
          passes_(device, screenOptions(desc, 1)),
          light_(device, {patternOf(desc), true, false}),
          ambient_(device, {patternOf(desc), false, desc.weighting == LW_AMBIENT_UNIFORM}) {}

    void update(Executor&, const LWFrame& frame) override {
        const bool lost = continuity_.beginLost(), forget = frame.reset != 0 || lost;
        if (desc_.history) turn_ = forget ? 0 : turn_ + 1;
        if (lost) {  // tables and borders that are written once may never have been
            states_.clear();
        }
        unused_ = unusedByScreen(frame);
        states_.purge();
        states_.each([&](HorizonView& state) { state.screen.startFrame(forget); });
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        ScreenView::check(device_, *view, output, "horizon");
        const Camera camera(gbuffer.camera, view->width, view->height, "gbuffer.camera");
        HorizonView& state = states_.get(view, [&] {
            return std::unique_ptr<HorizonView>(new HorizonView{{device_, screenOptions(desc_, view->maxHeight)}, {}, {}});
        });
        ScreenView& screen = state.screen;
        screen.begin(executor, *view, gbuffer, output, camera, passes_, turn_);
        HorizonTables& tables = screen.wantsLight() ? state.withLight : state.plain;
        tables.prepare(executor, patternOf(desc_), reachPixels(desc_, view->height), isHalf(desc_) ? 2.0 : 1.0, screen.levels());
        const HorizonRanges ranges = {desc_.thickness, desc_.ambientRadius};
        const auto gather = [&](HorizonGather& pass, bool light) {
            pass.recordGather(executor, screen.levels(), view->height, camera, ranges, tables, turn_, screen.gathered(light));
        };
        // Light is weighted by the cosine; ambient occlusion of the same weighting comes with it.
        const bool together = screen.wantsLight() && desc_.weighting == LW_AMBIENT_COSINE;
        if (screen.wantsLight()) {
            gather(light_, true);
            screen.finishLight(executor, passes_, together);
        }
        if (screen.wantsAmbient() && !together) {
            gather(ambient_, false);
            screen.finishAmbient(executor, passes_);
        }
        screen.end(executor, passes_);
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        HorizonTechnique twin(device_, desc_);
        exerciseTechnique(executor, twin, kMakesAmbient);
    }

    Report report() override {
        Report report;
        for (const LWChoice& choice : unused_) report.choose(choice.name, choice.reason);
        if (rowsOf(desc_) != desc_.interleave) report.choose("interleave", "fewer rows: the most that share out the directions evenly");
        ScreenView::startReport(screenOptions(desc_, 1), report);
        states_.each([&](const HorizonView& state) { state.screen.report(device_, report); });
        return report;
    }

    std::vector<DebugView> debugViews(const View* view) override {
        std::vector<DebugView> views;
        if (const HorizonView* state = states_.find(view)) state->screen.addDebugViews(passes_, views);
        return views;
    }

    std::uint64_t bytes() const override {
        std::uint64_t total = 0;
        states_.each([&](const HorizonView& state) {
            total += state.screen.bytes() + state.withLight.bytes() + state.plain.bytes();
        });
        return total;
    }

private:
    Device& device_;
    LWHorizonDesc desc_;
    Continuity continuity_{device_};
    std::uint32_t turn_ = 0;      // of the pattern, one a frame while there is a history
    ScreenPasses passes_;
    HorizonGather light_, ambient_;
    PerView<HorizonView> states_;
    std::vector<LWChoice> unused_;  // of the last update
};

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWHorizonDesc& horizon = *static_cast<const LWHorizonDesc*>(desc);
    return ScreenView::estimateBytes(screenOptions(horizon, view.maxHeight), view, shape.uploads) +
           2 * HorizonTables::estimateBytes(patternOf(horizon), reachPixels(horizon, view.maxHeight));
}

}  // namespace

const TechniqueEntry& horizonEntry() {
    static const TechniqueEntry entry = techniqueEntry<HorizonTechnique, LWHorizonDesc, lwDefaultHorizon>(
        "horizon", "ambient occlusion and one bounce from the view's own pixels: slices with a visibility bitmask", 1,
        horizonParameters(), horizonSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
