// Frame part, report and registration; the table of parameters is lpv_parameters.cpp's.
#include "techniques/lpv.h"

#include <memory>
#include <optional>
#include <vector>

#include "compute/device.h"
#include "inputs/geometry_box.h"
#include "inputs/rsm_input.h"
#include "techniques/lpv_parameters.h"
#include "techniques/lpv_view.h"
#include "techniques/lpv_volume.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

bool isHalf(const LWLpvDesc& desc) { return desc.resolution == LW_RESOLUTION_HALF; }

// Geometry and source views apart, which the volume speaks of.
std::vector<LWChoice> unusedInputs(const LWFrame& frame) {
    constexpr const char* kReason = "not used: technique lpv takes light from RSMs and authored VPLs only";
    std::vector<LWChoice> unused;
    if (frame.blockerCount) unused.push_back({"frame.blockers", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (frame.lights[l].rsmCount == 0) {
            unused.push_back({"frame.lights", "some have no RSM: technique lpv makes no indirect light of those"});
            break;
        }
    return unused;
}

class LpvTechnique final : public Technique {
public:
    LpvTechnique(Device& device, const LWLpvDesc& desc, int hidden = 0)
        : device_(device), desc_(desc), hidden_(hidden), failures_(device.failures()), volume_(makeLpvVolume(device, desc, hidden)) {
        if (isHalf(desc)) bilateral_.emplace(device);
        for (int a = 0; a < 3; ++a) placement_.centre[a] = desc.center[a];
        placement_.extent = desc.extent;
    }

    void update(Executor& executor, const LWFrame& frame) override {
        const bool failed = device_.failures() != failures_ || isCut_;
        if (failed) remake();
        volume_->check(frame);
        box_.look(frame.geometry);
        rsms_.import(executor, frame);
        isCut_ = true;
        failures_ = device_.failures();
        place(frame, failed);
        volume_->record(executor, frame, rsms_, placement_);
        for (std::size_t c = 0; c < 3; ++c) environment_[c] = frame.environment[c];
        choices_ = unusedInputs(frame);
        const double side = desc_.extent > 0.0f ? double(desc_.extent) : double(box_.longest());
        for (const LWChoice& choice : volume_->choices(frame, side)) choices_.push_back(choice);
        isCut_ = false;
        states_.purge();
        states_.each([](LpvView& state) { state.startFrame(); });
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "lpv", volume_->hasSpecular());
        const std::optional<LwSpecularRays> rays = LpvSpecularView::rays(*view, gbuffer, output, environment_);
        LpvView& state = states_.get(view, [&] { return std::make_unique<LpvView>(device_, *view, isHalf(desc_)); });
        state.render(executor, *view, gbuffer, output, bilateral_ ? &*bilateral_ : nullptr, *volume_, rays);
    }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        if (desc_.transport == LW_LPV_TRANSPORT_SWEEP)
            prewarmSweep(executor);
        else
            prewarmSteps(executor);
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    // What its memory holds is not known.
    void remake() {
        isCut_ = true;
        volume_.reset();
        volume_ = makeLpvVolume(device_, desc_, hidden_);
    }
    void place(const LWFrame& frame, bool failed) {
        placement_.hasBox = box_.isSome();
        for (int a = 0; a < 3; ++a) {
            placement_.low[a] = box_.low()[a];
            placement_.high[a] = box_.high()[a];
        }
        placement_.refit = frame.reset != 0 || failed;
    }

    // Frames may bring all of the sources or none, and `auto` takes the first there is.
    void prewarmSteps(Executor& executor) {
        LWLpvDesc desc = desc_;
        desc.steps = desc.steps == 1 ? 1 : 2;
        for (int source = LW_GEOMETRY_VOLUME_TRIANGLES; source <= LW_GEOMETRY_VOLUME_SCREEN; ++source) {
            if (desc_.geometryVolume == LW_GEOMETRY_VOLUME_AUTO) desc.geometryVolume = LWGeometryVolume(source);
            else if (source != LW_GEOMETRY_VOLUME_TRIANGLES) break;
            LpvTechnique twin(device_, desc);
            exerciseTechnique(executor, twin, false, twin.volume_->hasSpecular());
        }
        desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
        LpvTechnique(device_, desc).prewarmVpls(executor);
    }
    void prewarmSweep(Executor& executor) {
        LWLpvDesc desc = desc_;
        desc.size = 16;  // the same kernels, in less memory
        desc.directions = 24;
        for (int hidden = 0; hidden < kLpvBlockerKinds; ++hidden) {
            LpvTechnique twin(device_, desc, hidden);
            twin.prewarmVpls(executor);
            exerciseTechnique(executor, twin, false, twin.volume_->hasSpecular());
        }
    }
    // A frame of VPLs, which exerciseTechnique's have none of.
    void prewarmVpls(Executor& executor) {
        LWVpl vpl{};
        vpl.normal[1] = vpl.flux[0] = 1.0f;
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.vpls = &vpl;
        frame.vplCount = 1;
        update(executor, frame);
    }

    Device& device_;
    LWLpvDesc desc_;
    int hidden_;              // see makeLpvVolume
    std::uint64_t failures_;  // that the device had seen when the last update began
    bool isCut_ = false;      // the last update was not recorded to its end: what is kept from frame to frame may be half made
    GeometryBox box_;
    LpvPlacement placement_;
    RsmInput rsms_;
    std::unique_ptr<LpvVolume> volume_;
    std::optional<JointBilateral> bilateral_;  // with resolution=half
    PerView<LpvView> states_;
    std::vector<LWChoice> choices_;  // of the last update
    float environment_[3] = {0.0f, 0.0f, 0.0f};
};

Report LpvTechnique::report() {
    Report report;
    rsms_.report(report);
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    if (volume_) volume_->report(report);
    LpvView::startReport(report);
    states_.each([&](const LpvView& state) { state.report(device_, report); });
    return report;
}

std::vector<DebugView> LpvTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (volume_) volume_->addDebugViews(views);
    if (const LpvView* state = states_.find(view)) state->addDebugViews(views);
    return views;
}

std::uint64_t LpvTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + (volume_ ? volume_->bytes() : 0);
    states_.each([&](const LpvView& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWLpvDesc& lpv = *static_cast<const LWLpvDesc*>(desc);
    return RsmInput::estimateBytes(shape) + estimateLpvVolumeBytes(lpv, shape) + LpvView::estimateBytes(view, isHalf(lpv), shape.uploads);
}

}  // namespace

const TechniqueEntry& lpvEntry() {
    static const TechniqueEntry entry = techniqueEntry<LpvTechnique, LWLpvDesc, lwDefaultLpv>(
        "lpv", "light propagation volumes: RSMs' light spread from cell to cell of a grid", 1, lpvParameters(),
        lpvSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
