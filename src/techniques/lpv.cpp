// Frame part, report and registration; the table of parameters is lpv_parameters.cpp's.
#include "techniques/lpv.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/geometry_box.h"
#include "inputs/image_check.h"
#include "inputs/rsm_input.h"
#include "shared/lpv_types.h"
#include "techniques/lpv_parameters.h"
#include "techniques/lpv_points.h"
#include "techniques/lpv_view.h"
#include "techniques/lpv_volume.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// One grid within another has all kernels of many, which take up to six times a grid's memory.
constexpr std::uint32_t kPrewarmedCascades = 2;

bool isHalf(const LWLpvDesc& desc) { return desc.resolution == LW_RESOLUTION_HALF; }

// Geometry and source views apart, which the volume speaks of.
std::vector<LWChoice> unusedInputs(const LWFrame& frame) {
    std::vector<LWChoice> unused;
    if (frame.blockerCount)
        unused.push_back({"frame.blockers", "not used: in technique lpv triangles, surfels or texels block light"});
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (frame.lights[l].rsmCount == 0) {
            unused.push_back({"frame.lights", "some have no RSM: technique lpv makes no indirect light of those"});
            break;
        }
    return unused;
}

void checkEnvironment(const LWFrame& frame) {
    for (int c = 0; c < 3; ++c)
        if (frame.environment[c] > LW_LPV_LARGEST_ENVIRONMENT)
            fail(LW_ERROR_INVALID_ARGUMENT, "frame.environment[", c, "]: expected a radiance of at most ",
                 LW_LPV_LARGEST_ENVIRONMENT, ", got ", frame.environment[c]);
}

class LpvTechnique final : public Technique {
public:
    LpvTechnique(Device& device, const LWLpvDesc& desc, int hidden = 0)
        : device_(device), desc_(desc), hidden_(hidden), volume_(makeLpvVolume(device, desc, hidden)) {
        if (isHalf(desc)) bilateral_.emplace(device);
        placement_.extent = desc.extent;
    }

    void update(Executor& executor, const LWFrame& frame) override {
        checkEnvironment(frame);
        volume_->check(frame);
        box_.look(frame);
        rsms_.import(executor, frame);
        const bool lost = continuity_.beginLost();
        if (lost) remake();
        place(frame, lost);
        volume_->record(executor, frame, rsms_, placement_);
        for (std::size_t c = 0; c < 3; ++c) environment_[c] = frame.environment[c];
        choices_ = unusedInputs(frame);
        if (desc_.extent > 0.0f && frame.focus) choices_.push_back({"center", "not used: the grid lies around frame.focus"});
        const double side = desc_.extent > 0.0f ? double(desc_.extent) : double(box_.longest());
        for (const LWChoice& choice : volume_->choices(frame, side)) choices_.push_back(choice);
        states_.purge();
        states_.each([](LpvView& state) { state.startFrame(); });
        if (points_) points_->startFrame();
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override {
        if (!imageAbsent(output.specularRadiance) && !volume_->hasSpecular())
            fail(LW_ERROR_UNSUPPORTED, "output.specularRadiance: technique lpv makes it with cascades=1 only, got cascades=",
                 desc_.cascades);
        checkLightOutputs(device_, *view, output, "lpv", kMakesSpecular);
        const std::optional<LwSpecularRays> rays = LpvSpecularView::rays(*view, gbuffer, output, environment_);
        LpvView& state = states_.get(view, [&] { return std::make_unique<LpvView>(device_, *view, isHalf(desc_)); });
        state.render(executor, *view, gbuffer, output, bilateral_ ? &*bilateral_ : nullptr, *volume_, rays);
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkPoints(device_, points);
        if (!points_) points_.emplace(device_);
        points_->render(executor, points, *volume_);
    }

    void lose() override { continuity_.lose(); }

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
        volume_ = makeLpvVolume(device_, desc_, hidden_);
    }
    void place(const LWFrame& frame, bool lost) {
        placement_.hasBox = box_.isSome();
        for (int a = 0; a < 3; ++a) {
            placement_.low[a] = box_.low()[a];
            placement_.high[a] = box_.high()[a];
        }
        placement_.refit = frame.reset != 0 || lost;
        placement_.hasFocus = frame.focus != nullptr;
        for (int a = 0; a < 3; ++a) {
            placement_.centre[a] = float(double(desc_.center[a]) - frame.worldOrigin[a]);
            placement_.focus[a] = frame.focus ? frame.focus[a] : 0.0f;
        }
    }

    // Frames may bring all of the sources or none, and `auto` takes the first there is.
    void prewarmSteps(Executor& executor) {
        LWLpvDesc desc = desc_;
        desc.cascades = std::min(desc.cascades, kPrewarmedCascades);
        desc.steps = desc.steps == 1 ? 1 : 2;
        for (int source = LW_GEOMETRY_VOLUME_TRIANGLES; source <= LW_GEOMETRY_VOLUME_SCREEN; ++source) {
            if (desc_.geometryVolume == LW_GEOMETRY_VOLUME_AUTO) desc.geometryVolume = LWGeometryVolume(source);
            else if (source != LW_GEOMETRY_VOLUME_TRIANGLES) break;
            LpvTechnique twin(device_, desc);
            exerciseTechnique(executor, twin, twin.volume_->hasSpecular() ? kMakesSpecular : 0u);
            exercisePoints(executor, twin);
        }
        desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
        LpvTechnique(device_, desc).prewarmVpls(executor);
    }
    void prewarmSweep(Executor& executor) {
        LWLpvDesc desc = desc_;
        desc.size = 16;  // the same kernels, in less memory
        desc.cascades = std::min(desc.cascades, kPrewarmedCascades);
        desc.directions = 24;
        for (int hidden = 0; hidden < kLpvBlockerKinds; ++hidden) {
            LpvTechnique twin(device_, desc, hidden);
            twin.prewarmVpls(executor);
            exerciseTechnique(executor, twin, twin.volume_->hasSpecular() ? kMakesSpecular : 0u);
            exercisePoints(executor, twin);
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
    Continuity continuity_{device_};
    GeometryBox box_;
    LpvPlacement placement_;
    RsmInput rsms_;
    std::unique_ptr<LpvVolume> volume_;
    std::optional<JointBilateral> bilateral_;  // with resolution=half
    PerView<LpvView> states_;
    std::optional<LpvPoints> points_;  // from the first lwRenderPoints on
    std::vector<LWChoice> choices_;  // of the last update
    float environment_[3] = {0.0f, 0.0f, 0.0f};
};

Report LpvTechnique::report() {
    Report report;
    rsms_.report(report);
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    volume_->report(report);
    LpvView::startReport(report);
    states_.each([&](const LpvView& state) { state.report(device_, report); });
    if (points_) points_->report(report);
    return report;
}

std::vector<DebugView> LpvTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    volume_->addDebugViews(views);
    if (const LpvView* state = states_.find(view)) state->addDebugViews(views);
    return views;
}

std::uint64_t LpvTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + volume_->bytes() + (points_ ? points_->bytes() : 0);
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
