// Frame part, per-view state, report and registration; the table of parameters is rsm_parameters.cpp's.
#include "techniques/rsm.h"

#include <algorithm>
#include <optional>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/rsm_input.h"
#include "passes/vpl_sampling.h"
#include "techniques/interleaved_view.h"
#include "techniques/prewarm.h"
#include "techniques/rsm_parameters.h"
#include "techniques/rsm_shadows.h"
#include "techniques/technique_entry.h"
#include "techniques/vpl_points.h"

namespace lightwell {
namespace {

bool isShadowed(const LWRsmDesc& desc) { return desc.visibility == LW_RSM_VISIBILITY_VOXEL; }

VplSamplingOptions samplingOptions(const LWRsmDesc& desc) {
    VplSamplingOptions options;
    options.count = desc.vpls;
    options.uniform = desc.sampling == LW_SAMPLING_UNIFORM;
    options.view = desc.sampling == LW_SAMPLING_VIEW;
    // Shadowed ones in their own order: clusters are dealt out, not this list.
    options.subsets = isShadowed(desc) ? 1 : desc.interleave * desc.interleave;
    options.seed = desc.seed;
    return options;
}

// A list of any length takes the same kernels in the same groups.
constexpr std::uint32_t kPrewarmVpls = 1024;

InterleavedOptions interleavedOptions(const LWRsmDesc& desc) {
    InterleavedOptions options;
    options.interleave = desc.interleave;
    options.filter = desc.filter != 0;
    options.halvings = desc.autoResolution > 0.0f ? 1 : std::uint32_t(desc.resolution);
    options.history = {desc.history, desc.historyClamp, 0};
    options.repairs = desc.autoResolution;
    return options;
}

// What the host gave and this technique does not read: said in the stats, so that nobody waits for its light.
std::vector<LWChoice> inputChoices(const LWFrame& frame, const RsmShadows* shadows, bool usesViews) {
    constexpr const char* kReason = "not used: technique rsm takes light from RSMs and authored VPLs only";
    std::vector<LWChoice> unused;
    if (shadows) unused = shadows->choices(frame, usesViews);
    else if (frame.sourceViewCount && !usesViews) unused.push_back({"frame.sourceViews", kReason});
    if (frame.geometry && !shadows) unused.push_back({"frame.geometry", kReason});
    if (frame.blockerCount) unused.push_back({"frame.blockers", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (frame.lights[l].rsmCount == 0) {
            unused.push_back({"frame.lights", "some have no RSM: technique rsm makes no indirect light of those"});
            break;
        }
    return unused;
}

class RsmTechnique final : public Technique {
public:
    RsmTechnique(Device& device, const LWRsmDesc& desc, RsmShadows::Source source = RsmShadows::Source::best)
        : device_(device), desc_(desc), sampling_(device, samplingOptions(desc)), gather_(device, desc.interleave) {
        // A program built for nothing is also never cached.
        if (interleavedOptions(desc).halvings) bilateral_.emplace(device, 3, repairs());
        if (repairs()) {
            repair_.emplace(device);
            gatherAll_.emplace(device, 1);
        }
        if (desc.history) history_.emplace(device, interleavedOptions(desc).history);
        if (isShadowed(desc)) shadows_.emplace(device, desc, source);
    }

    void update(Executor& executor, const LWFrame& frame) override {
        sampling_.check(frame);
        if (shadows_) shadows_->check(frame);
        rsms_.import(executor, frame);
        const bool lost = continuity_.beginLost(), forget = lost || frame.reset != 0;
        if (history_) sampling_.turn(forget ? turns_ = 0 : ++turns_);
        sampling_.importViews(executor, frame);
        sampling_.record(executor, rsms_, frame.vpls, frame.vplCount);
        if (shadows_) shadows_->update(executor, frame, rsms_, {sampling_.vpls(), sampling_.vplCount()}, forget, lost);
        choices_ = inputChoices(frame, shadows_ ? &*shadows_ : nullptr, desc_.sampling == LW_SAMPLING_VIEW);
        states_.purge();
        states_.each([&](InterleavedView& state) { state.startFrame(forget); });
        if (points_) points_->startFrame();
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "rsm");
        InterleavedView& state = states_.get(
            view, [&] { return std::make_unique<InterleavedView>(device_, interleavedOptions(desc_), *view); });
        const Buffer& vpls = this->vpls();
        const lw_subset_order order = this->order();
        state.render(executor, *view, gbuffer, output, {gather_, bilateral_ ? &*bilateral_ : nullptr, history(), repair_ ? &*repair_ : nullptr},
                     [&](const Planes& position, const Planes& normal, const Planes& irradiance) {
                         const Buffer& masks = state.cull(executor, gather_, position, normal, vpls, order);
                         if (shadows_)
                             return shadows_->recordGather(executor, position, normal, masks, irradiance, state.counts());
                         gather_.recordGather(executor, position, normal, vpls, order, masks, irradiance, state.counts());
                     },
                     [&](const Planes& position, const Planes& normal, const Planes& irradiance) {
                         gatherAll(executor, state, position, normal, irradiance);
                     });
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkPoints(device_, points);
        if (shadows_) return shadows_->renderPoints(executor, points);
        if (!points_) points_.emplace(device_);
        points_->render(executor, points, sampling_.vpls(), sampling_.order());
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        // A twin, so that this technique's frame stays as it is; kernels belong to the device.
        LWRsmDesc desc = desc_;
        desc.vpls = std::min(desc.vpls, kPrewarmVpls);
        using Source = RsmShadows::Source;
        for (const Source source : {Source::triangles, Source::surfels, Source::screen}) {  // each that a frame may bring
            RsmTechnique twin(device_, desc, source);
            exerciseTechnique(executor, twin);
            exercisePoints(executor, twin);
            if (!shadows_) break;
        }
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    bool repairs() const { return desc_.autoResolution > 0.0f; }
    // All VPLs at each pixel.
    void gatherAll(Executor& executor, InterleavedView& state, const Planes& position, const Planes& normal, const Planes& irradiance) {
        const Buffer& vpls = shadows_ ? shadows_->wholeVpls() : sampling_.vpls();
        const lw_subset_order order = shadows_ ? shadows_->wholeOrder() : wholeOrder(sampling_.order());
        const Buffer& masks = state.cullAll(executor, *gatherAll_, position, normal, vpls, order);
        if (shadows_) return shadows_->recordGatherAll(executor, position, normal, masks, irradiance, state.repairCounts());
        gatherAll_->recordGather(executor, position, normal, vpls, order, masks, irradiance, state.repairCounts());
    }
    TemporalHistory* history() { return history_ ? &*history_ : nullptr; }
    // As the gather walks them.
    const Buffer& vpls() const { return shadows_ ? shadows_->vpls() : sampling_.vpls(); }
    lw_subset_order order() const { return shadows_ ? shadows_->order() : sampling_.order(); }

    Device& device_;
    LWRsmDesc desc_;
    Continuity continuity_{device_};
    std::uint32_t turns_ = 0;     // of the sample set, one a frame while there is a history
    RsmInput rsms_;
    VplSampling sampling_;
    InterleavedGather gather_;
    std::optional<JointBilateral> bilateral_;  // reduced resolution only
    std::optional<PixelRepair> repair_;        // with desc.autoResolution only
    std::optional<InterleavedGather> gatherAll_;
    std::optional<RsmShadows> shadows_;        // with visibility only
    std::optional<TemporalHistory> history_;
    PerView<InterleavedView> states_;
    std::optional<VplPoints> points_;  // from the first lwRenderPoints on
    std::vector<LWChoice> choices_;  // of the last update
};

Report RsmTechnique::report() {
    Report report;
    rsms_.report(report);
    // With every texel a VPL, the list also holds the dark padding of the maps' rows.
    const std::uint32_t padding = desc_.vpls == 0 ? rsms_.texels.width - rsms_.texelCount : 0;
    report.counts.push_back({"vpls", sampling_.vplCount() - padding});
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    report.counts.push_back({"rejected_pixels", 0});
    report.counts.push_back({"upsample_fallbacks", 0});
    report.counts.push_back({"saturated_pixels", 0});
    if (repairs()) {
        report.counts.push_back({"repaired_pixels", 0});
        report.counts.push_back({"unrepaired_pixels", 0});
    }
    if (history_) report.counts.push_back({"history_new", 0});
    states_.each([&](const InterleavedView& state) { state.report(device_, report, order()); });
    if (shadows_) shadows_->report(report);
    if (points_) points_->report(report);
    return report;
}

std::vector<DebugView> RsmTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (vpls())
        views.push_back({"vpls", "one column per slot: position xyz (m), unit normal xyz, flux rgb (W), area (m^2)",
                         VplSampling::debugShape(order()),
                         [this](Executor& executor, const Planes& planes) {
                             sampling_.recordPlanes(executor, vpls(), planes);
                         }});
    if (const InterleavedView* state = states_.find(view)) state->addDebugViews(views, history(), repair_ ? &*repair_ : nullptr);
    return views;
}

std::uint64_t RsmTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + sampling_.bytes() + (points_ ? points_->bytes() : 0) + (shadows_ ? shadows_->bytes() : 0);
    states_.each([&](const InterleavedView& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWRsmDesc& rsm = *static_cast<const LWRsmDesc*>(desc);
    lw_subset_order order = VplSampling::orderOf(samplingOptions(rsm), shape), whole = wholeOrder(order);
    std::uint64_t total = RsmInput::estimateBytes(shape) + VplSampling::estimateBytes(samplingOptions(rsm), shape);
    if (isShadowed(rsm)) {
        const std::uint32_t count = std::uint32_t(order.count);
        total += RsmShadows::estimateBytes(rsm, count, shape);
        order = RsmShadows::orderOf(rsm, count);
        whole = RsmShadows::wholeOrderOf(count);
    }
    return total + InterleavedView::estimateBytes(interleavedOptions(rsm), view, shape.uploads, order, whole);
}

}  // namespace

const TechniqueEntry& rsmEntry() {
    static const TechniqueEntry entry = techniqueEntry<RsmTechnique, LWRsmDesc, lwDefaultRsm>(
        "rsm", "virtual point lights from reflective shadow maps, gathered without visibility or with that of voxels", 1, rsmParameters(),
        rsmSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
