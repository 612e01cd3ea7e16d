// Frame part, report and registration; the table of parameters is ao_parameters.cpp's.
#include "techniques/ao.h"

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "passes/point_occlusion.h"
#include "techniques/ao_parameters.h"
#include "techniques/prewarm.h"
#include "techniques/screen_view.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

ScreenOptions screenOptions(const LWAoDesc& desc) {
    ScreenOptions options;
    options.half = desc.resolution == LW_RESOLUTION_HALF;
    options.columns = options.rows = desc.filter ? 4 : 1;
    options.extras = kPyramidDepth;
    options.history = {desc.history, desc.historyClamp, 2};
    return options;
}

PointOcclusionOptions pointOptions(const LWAoDesc& desc, bool light) {
    PointOcclusionOptions options;
    options.points = desc.samples;
    options.radius = desc.radius;
    options.packed = desc.packing != 0;
    options.rangeCheck = desc.rangeCheck != 0;
    options.cosine = desc.weighting == LW_AMBIENT_COSINE;
    options.light = light;
    return options;
}

class AoTechnique final : public Technique {
public:
    AoTechnique(Device& device, const LWAoDesc& desc)
        : device_(device),
          desc_(desc),
          passes_(device, screenOptions(desc)),
          light_(device, pointOptions(desc, true)),
          ambient_(device, pointOptions(desc, false)) {}

    void update(Executor&, const LWFrame& frame) override {
        const bool lost = continuity_.beginLost(), forget = frame.reset != 0 || lost;
        if (desc_.history) turn_ = forget ? 0 : turn_ + 1;
        if (lost) {  // tables and borders that are written once may never have been
            states_.clear();
            light_.forget();
            ambient_.forget();
        }
        unused_ = unusedByScreen(frame);
        states_.purge();
        states_.each([&](ScreenView& state) { state.startFrame(forget); });
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        ScreenView::check(device_, *view, output, "ao");
        for (const auto& [image, name] : {std::pair{&output.irradiance, "irradiance"}, {&output.validity, "validity"}})
            if (desc_.method == LW_AO_SSAO && rawEnum(image->format) != LW_FORMAT_NONE)
                fail(LW_ERROR_UNSUPPORTED, "output.", name, ": technique ao with method ssao makes ambientOcclusion only");
        const Camera camera(gbuffer.camera, view->width, view->height, "gbuffer.camera");
        ScreenView& state = states_.get(view, [&] { return std::make_unique<ScreenView>(device_, screenOptions(desc_)); });
        state.begin(executor, *view, gbuffer, output, camera, passes_, turn_);
        const bool light = state.wantsLight();
        const std::uint32_t base = state.levels().options().firstLevel;
        (light ? light_ : ambient_)
            .record(executor, state.levels().level(base), 1u << base, view->height, camera, turn_, state.gathered(light));
        if (light)
            state.finishLight(executor, passes_, true);
        else
            state.finishAmbient(executor, passes_);
        state.end(executor, passes_);
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        LWAoDesc desc = desc_;
        desc.method = LW_AO_SSDO;  // whose kernels are those of both
        AoTechnique twin(device_, desc);
        exerciseTechnique(executor, twin, kMakesAmbient);
    }

    Report report() override {
        Report report;
        for (const LWChoice& choice : unused_) report.choose(choice.name, choice.reason);
        ScreenView::startReport(screenOptions(desc_), report);
        states_.each([&](const ScreenView& state) { state.report(device_, report); });
        return report;
    }

    std::vector<DebugView> debugViews(const View* view) override {
        std::vector<DebugView> views;
        if (const ScreenView* state = states_.find(view)) state->addDebugViews(passes_, views);
        return views;
    }

    std::uint64_t bytes() const override {
        std::uint64_t total = light_.bytes() + ambient_.bytes();
        states_.each([&](const ScreenView& state) { total += state.bytes(); });
        return total;
    }

private:
    Device& device_;
    LWAoDesc desc_;
    Continuity continuity_{device_};
    std::uint32_t turn_ = 0;      // of the pattern, one a frame while there is a history
    ScreenPasses passes_;
    PointOcclusion light_, ambient_;
    PerView<ScreenView> states_;
    std::vector<LWChoice> unused_;  // of the last update
};

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWAoDesc& ao = *static_cast<const LWAoDesc*>(desc);
    return ScreenView::estimateBytes(screenOptions(ao), view, shape.uploads) +
           2 * PointOcclusion::estimateBytes(pointOptions(ao, true));
}

}  // namespace

const TechniqueEntry& aoEntry() {
    static const TechniqueEntry entry = techniqueEntry<AoTechnique, LWAoDesc, lwDefaultAo>(
        "ao", "ambient occlusion (SSAO) and one bounce (SSDO) from points in the hemisphere that the view shows to be hidden", 1,
        aoParameters(), aoSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
