// Frame and view parts, report and registration; the table of parameters is screen_space_parameters.cpp's.
#include "techniques/screen_space.h"

#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/output_target.h"
#include "inputs/source_view.h"
#include "techniques/prewarm.h"
#include "techniques/screen_space_parameters.h"
#include "techniques/screen_picture.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

ScreenSpaceOptions optionsOf(const LWScreenSpaceDesc& desc) {
    ScreenSpaceOptions options;
    options.start = std::uint32_t(desc.start);
    options.levels = desc.levels;
    options.samples = desc.samples;
    options.radius = double(desc.radius);
    options.interleave = desc.interleave;
    options.bounded = desc.bounded != 0;
    options.cameras = desc.cameras != 0;
    options.seed = desc.seed;
    options.autoError = desc.autoError;
    options.history = {desc.history, desc.historyClamp, 1};
    return options;
}

// What the host gave and this technique does not read.
std::vector<LWChoice> unusedInputs(const LWFrame& frame, bool cameras) {
    constexpr const char* kReason = "not used: technique screen_space takes light from what cameras see only";
    std::vector<LWChoice> unused;
    if (frame.sourceViewCount && !cameras) unused.push_back({"frame.sourceViews", "not used: parameter cameras is off"});
    if (frame.lightCount) unused.push_back({"frame.lights", kReason});
    if (frame.vplCount) unused.push_back({"frame.vpls", kReason});
    if (frame.geometry) unused.push_back({"frame.geometry", kReason});
    if (frame.blockerCount) unused.push_back({"frame.blockers", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    return unused;
}

class ScreenSpaceTechnique final : public Technique {
public:
    ScreenSpaceTechnique(Device& device, const LWScreenSpaceDesc& desc)
        : device_(device), desc_(desc), options_(optionsOf(desc)), passes_(device, options_) {}

    // The other cameras' light.
    void update(Executor& executor, const LWFrame& frame) override {
        const std::uint32_t count = desc_.cameras ? frame.sourceViewCount : 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
            ScreenPicture::check(device_, options_, sourceViewOf(frame, i), gbuffer, sourceViewName(i));
        }
        unused_ = unusedInputs(frame, desc_.cameras != 0);
        const bool lost = continuity_.beginLost(), forget = frame.reset != 0 || lost;
        if (options_.keeps()) turn_ = forget ? 0 : turn_ + 1;
        if (lost) {  // patterns and borders that are written once may never have been
            states_.clear();
            sources_.clear();
        }
        states_.purge();
        states_.each([&](ViewState& state) { state.screen.startFrame(forget); });
        takeSources(frame, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
            sources_[i].screen->startFrame(forget);
            sources_[i].screen->light(executor, passes_, sourceViewOf(frame, i), gbuffer, sourceViewName(i), turn_);
        }
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "screen_space");
        ScreenPicture::check(device_, options_, *view, gbuffer, "gbuffer");
        ViewState& state = states_.get(view, [&] { return std::make_unique<ViewState>(device_, options_, *view); });
        state.screen.light(executor, passes_, *view, gbuffer, "gbuffer", turn_);
        const Planes irradiance = state.irradiance.begin(executor, *view, output.irradiance, 3, "output.irradiance");
        const Planes validity = state.validity.begin(executor, *view, output.validity, 1, "output.validity");
        state.screen.finish(executor, passes_, irradiance, validity);
        for (const Source& source : sources_)
            if (!source.view || source.view != view->handle)
                state.screen.join(executor, passes_, *source.screen, irradiance, validity);
        state.irradiance.end(executor);
        state.validity.end(executor);
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        ScreenSpaceTechnique twin(device_, desc_);
        exerciseTechnique(executor, twin);
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override {
        std::vector<DebugView> views;
        if (const ViewState* state = states_.find(view)) state->screen.addDebugViews(views, passes_);
        return views;
    }
    std::uint64_t bytes() const override;

private:
    struct ViewState {
        ViewState(Device& device, const ScreenSpaceOptions& options, const View& view)
            : screen(device, options, view.maxWidth, view.maxHeight) {}
        ScreenPicture screen;
        OutputTarget irradiance, validity;
    };
    struct Source {
        LWView view = nullptr;  // the host's handle: a view takes nothing from itself
        std::unique_ptr<ScreenPicture> screen;
    };

    // A picture for each source view: the one of the frame before that was of the same view, whatever its place in the list then,
    // so that its history is its own. Without a handle the place tells.
    void takeSources(const LWFrame& frame, std::uint32_t count) {
        std::vector<Source> next(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const View size = sourceViewOf(frame, i);
            next[i].view = frame.sourceViews[i].view;
            for (std::size_t j = 0; j < sources_.size() && !next[i].screen; ++j) {
                Source& before = sources_[j];
                if (before.screen && before.view == next[i].view && (before.view || i == j) &&
                    before.screen->maxWidth() == size.width && before.screen->maxHeight() == size.height)
                    next[i].screen = std::move(before.screen);
            }
        }
        sources_.clear();  // what is not taken gives its memory back first
        for (std::uint32_t i = 0; i < count; ++i) {
            const View size = sourceViewOf(frame, i);
            if (!next[i].screen) next[i].screen = std::make_unique<ScreenPicture>(device_, options_, size.width, size.height);
        }
        sources_ = std::move(next);
    }

    Device& device_;
    LWScreenSpaceDesc desc_;
    ScreenSpaceOptions options_;
    ScreenSpacePasses passes_;
    Continuity continuity_{device_};
    std::uint32_t turn_ = 0;      // of the sample patterns, one a frame while there is a history
    PerView<ViewState> states_;
    std::vector<Source> sources_;
    std::vector<LWChoice> unused_;  // of the last update
};

Report ScreenSpaceTechnique::report() {
    Report report;
    for (const LWChoice& choice : unused_) report.choose(choice.name, choice.reason);
    for (const char* name : {"rejected_pixels", "rejected_radiances", "upsample_fallbacks", "saturated_pixels"})
        report.counts.push_back({name, 0});
    if (options_.keeps()) report.counts.push_back({"history_new", 0});
    states_.each([&](const ViewState& state) {
        if (!state.screen.isLit()) return;
        state.screen.report(device_, report);
        state.irradiance.report(report);
        state.validity.report(report);
    });
    for (const Source& source : sources_) source.screen->report(device_, report);
    return report;
}

std::uint64_t ScreenSpaceTechnique::bytes() const {
    std::uint64_t total = 0;
    states_.each([&](const ViewState& state) { total += state.screen.bytes() + state.irradiance.bytes() + state.validity.bytes(); });
    for (const Source& source : sources_) total += source.screen->bytes();
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWScreenSpaceDesc& own = *static_cast<const LWScreenSpaceDesc*>(desc);
    std::uint64_t total = ScreenPicture::estimateBytes(optionsOf(own), view, shape.uploads) +
                          OutputTarget::estimateBytes(view, 3, shape.uploads) + OutputTarget::estimateBytes(view, 1, shape.uploads);
    if (!own.cameras) return total;
    for (const auto& [width, height] : shape.sources) {
        LWViewDesc source = view;
        source.maxWidth = width;
        source.maxHeight = height;
        total += ScreenPicture::estimateBytes(optionsOf(own), source, shape.uploads);
    }
    return total;
}

}  // namespace

const TechniqueEntry& screenSpaceEntry() {
    static const TechniqueEntry entry = techniqueEntry<ScreenSpaceTechnique, LWScreenSpaceDesc, lwDefaultScreenSpace>(
        "screen_space", "light between the surfaces on the screen, gathered on a pyramid of the G-buffer", 1,
        screenSpaceParameters(), screenSpaceSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
