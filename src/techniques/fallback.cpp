#include "techniques/fallback.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "inputs/output_target.h"
#include "techniques/fallback_points.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kPartPlanes = 3 + 1;  // irradiance, validity

// One technique's light of a view, kept on the device.
struct PartImages {
    PartImages(Device& device, const View& view, const char* irradianceName, const char* validityName)
        : irradiance(device, view.maxWidth, view.maxHeight, 3, irradianceName),
          validity(device, view.maxWidth, view.maxHeight, 1, validityName) {}

    std::size_t bytes() const { return irradiance.bytes() + validity.bytes(); }

    PlanarImage irradiance, validity;
};

class Fallback final : public Technique {
public:
    Fallback(Device& device, std::shared_ptr<Technique> first, std::shared_ptr<Technique> second)
        : device_(device),
          first_(std::move(first)),
          second_(std::move(second)),
          join_(device.programs().kernel("fallback/fallback", "fallback_join")) {}

    void update(Executor& executor, const LWFrame& frame) override {
        first_->update(executor, frame);  // what it refuses leaves both as they were
        // Should the second refuse the frame, the first has it already: the two no longer belong together.
        isWhole_ = false;
        second_->update(executor, frame);
        isWhole_ = true;
        states_.purge();
        states_.each([](ViewState& state) { state.isRendered = false; });
        if (points_) points_->startFrame();
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        checkWhole();
        checkLightOutputs(device_, *view, output, "fallback");
        ViewState& state = states_.get(view, [&] { return std::make_unique<ViewState>(device_, *view); });
        state.isRendered = false;
        const LWOutput firstOutput = partOutput(*view, state.first), secondOutput = partOutput(*view, state.second);
        first_->render(executor, view, gbuffer, firstOutput);
        second_->render(executor, view, gbuffer, secondOutput);
        join(executor, *view, state, output);
        state.isRendered = true;
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkWhole();
        checkPoints(device_, points);
        if (!points_) points_.emplace(device_, join_);
        points_->render(executor, points, *first_, *second_);
    }

    void prewarm(Executor& executor, const std::shared_ptr<View>& view) override;
    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    struct ViewState {
        ViewState(Device& device, const View& view)
            : first(device, view, "irradiance of fallback's first technique", "validity of fallback's first technique"),
              second(device, view, "irradiance of fallback's second technique", "validity of fallback's second technique"),
              saturated(device, sizeof(cl_int), "counts of a view") {}
        PartImages first, second;
        OutputTarget irradiance, validity;
        Buffer saturated;  // pixels whose sum was brought down
        bool isRendered = false;  // since the last update
    };

    static LWOutput partOutput(const View& view, const PartImages& images) {
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = imageOver(images.irradiance.planes(view.width, view.height), LW_FORMAT_PLANAR_FLOAT3);
        output.validity = imageOver(images.validity.planes(view.width, view.height), LW_FORMAT_FLOAT1);
        return output;
    }
    void checkWhole() const {
        if (!isWhole_)
            fail(LW_ERROR_NOT_UPDATED, "technique: expected an lwUpdate that both techniques accept before, got none");
    }
    void join(Executor& executor, const View& view, ViewState& state, const LWOutput& output);
    void runJoin(Executor& executor, const View& view, ViewState& state, const Planes& irradiance, const Planes& validity);
    const char* named(const char* part, const char* name);

    Device& device_;
    std::shared_ptr<Technique> first_, second_;
    Kernel& join_;
    bool isWhole_ = false;  // both techniques hold the same frame
    PerView<ViewState> states_;
    std::optional<FallbackPoints> points_;  // from the first lwRenderPoints on
    std::set<std::string> names_;  // of both techniques' debug views
};

void Fallback::join(Executor& executor, const View& view, ViewState& state, const LWOutput& output) {
    const Planes irradiance = state.irradiance.begin(executor, view, output.irradiance, 3, "output.irradiance");
    const Planes validity = state.validity.begin(executor, view, output.validity, 1, "output.validity");
    runJoin(executor, view, state, irradiance, validity);
    state.irradiance.end(executor);
    state.validity.end(executor);
}

// E = E1 + (1 - v1) E2, v = v1 + (1 - v1) v2; of the two whichever is wanted.
void Fallback::runJoin(Executor& executor, const View& view, ViewState& state, const Planes& irradiance,
                       const Planes& validity) {
    const std::uint32_t w = view.width, h = view.height;
    const Planes e1 = state.first.irradiance.planes(w, h), v1 = state.first.validity.planes(w, h);
    const Planes e2 = state.second.irradiance.planes(w, h), v2 = state.second.validity.planes(w, h);
    executor.fill("fallback.counts", state.saturated, 0, 0, state.saturated.bytes());
    // A kernel's arguments must be set: an output that is not wanted is an input that is not written.
    executor.run("fallback.join", join_, rowGrid(device_, w, h), rowGroup(device_), e1, v1, e2, v2, cl_int(w), cl_int(h),
                 cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0), irradiance ? irradiance : e1,
                 validity ? validity : v1, state.saturated);
}

void Fallback::prewarm(Executor& executor, const std::shared_ptr<View>& view) {
    // The parts' own prewarming also covers what packs outputs.
    first_->prewarm(executor, view);
    second_->prewarm(executor, view);
    const View small(16, 16);
    ViewState state(device_, small);
    runJoin(executor, small, state, state.first.irradiance.planes(16, 16), Planes{});
    const FallbackPoints points(device_, join_);
    points.exercise(executor);
    device_.finish();
}

Report Fallback::report() {
    Report report;
    report.add("first", first_->report());
    report.add("second", second_->report());
    report.counts.push_back({"saturated_pixels", 0});
    states_.each([&](const ViewState& state) {
        if (!state.isRendered) return;
        state.irradiance.report(report);
        state.validity.report(report);
        report.read(device_, "saturated_pixels", state.saturated, 0);
    });
    if (points_) points_->report(report);
    return report;
}

const char* Fallback::named(const char* part, const char* name) {
    return names_.insert(std::string(part) + "." + name).first->c_str();
}

std::vector<DebugView> Fallback::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (const ViewState* state = states_.find(view); state && state->isRendered) {
        const std::uint32_t w = view->width, h = view->height;
        views.push_back({"first", "irradiance of the first technique (W/m^2)", state->first.irradiance.planes(w, h), {}});
        views.push_back({"first_validity", "the share that it has seen", state->first.validity.planes(w, h), {}});
        views.push_back({"second", "irradiance of the second technique (W/m^2)", state->second.irradiance.planes(w, h), {}});
    }
    for (DebugView& part : first_->debugViews(view)) {
        views.push_back(part);
        views.back().name = named("first", part.name);
    }
    for (DebugView& part : second_->debugViews(view)) {
        views.push_back(part);
        views.back().name = named("second", part.name);
    }
    return views;
}

std::uint64_t Fallback::bytes() const {
    std::uint64_t total = first_->bytes() + second_->bytes() + (points_ ? points_->bytes() : 0);
    states_.each([&](const ViewState& state) {
        total += state.first.bytes() + state.second.bytes() + state.irradiance.bytes() + state.validity.bytes() +
                 state.saturated.bytes();
    });
    return total;
}

// ------------------------------------------------------------------------------------- registration

// What joining takes beside the two techniques.
std::uint64_t estimateBytes(const void*, const LWViewDesc& view, const FrameShape& shape) {
    const std::uint64_t plane = std::uint64_t(paddedWidth(view.maxWidth)) * view.maxHeight * sizeof(float);
    return 2 * kPartPlanes * plane + sizeof(cl_int) + OutputTarget::estimateBytes(view, 3, shape.uploads) +
           OutputTarget::estimateBytes(view, 1, shape.uploads);
}

// The command line makes its two techniques by these names; a host gives any two.
const char* const kFirst[] = {"horizon", "screen_space", "rsm", nullptr};
const char* const kSecond[] = {"ssvp", "rsm", "lpv", "cone_tracing", nullptr};
// A chart joins each first technique that knows a part of the hemisphere with each second one.
const double kFirstSweep[] = {0, 1}, kSecondSweep[] = {0, 1};

const LWParameter kParameters[] = {
    {"first", "technique whose light counts as far as its validity reaches", LW_PARAMETER_TECHNIQUE,
     std::uint32_t(offsetof(LWFallbackDesc, first)), 0.0, 2.0, 0.0, kFirst, nullptr, 0, kFirstSweep, 2},
    {"second", "technique that lights the rest of each pixel's hemisphere", LW_PARAMETER_TECHNIQUE,
     std::uint32_t(offsetof(LWFallbackDesc, second)), 0.0, 3.0, 0.0, kSecond, nullptr, 0, kSecondSweep, 2},
};

}  // namespace

std::unique_ptr<Technique> joinTechniques(Device& device, const std::vector<std::shared_ptr<Technique>>& techniques) {
    return std::make_unique<Fallback>(device, techniques[0], techniques[1]);
}

const TechniqueEntry& fallbackEntry() {
    static const TechniqueEntry entry = [] {
        TechniqueEntry made{};
        made.info = {sizeof(LWTechniqueInfo), sizeof(LWFallbackDesc), "fallback",
                     "two techniques: where the first has not seen a pixel's hemisphere, the second lights it",
                     kParameters, 2, [](void* desc) { lwDefaultFallback(static_cast<LWFallbackDesc*>(desc)); }, 0, nullptr, 0, 1, 0};
        made.estimateBytes = estimateBytes;
        made.join = joinTechniques;
        return made;
    }();
    return entry;
}

}  // namespace lightwell

extern "C" void lwDefaultFallback(LWFallbackDesc* desc) {
    if (!desc) return;
    *desc = LWFallbackDesc{};
    desc->structSize = sizeof *desc;
}
