// Frame part, report and registration; the table of parameters is cone_tracing_parameters.cpp's.
#include "techniques/cone_tracing.h"

#include <memory>
#include <optional>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/rsm_input.h"
#include "techniques/cone_tracing_parameters.h"
#include "techniques/cone_tracing_points.h"
#include "techniques/cone_tracing_view.h"
#include "techniques/cone_tracing_volume.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// The least sizes of grids with the kernels of all: those of more than 64 voxels a side are shared out otherwise (VoxelGrid).
constexpr std::uint32_t kPrewarmedSmall = 32, kSmall = 64, kPrewarmedLarge = 128;
// Radiance from infinity above which it is refused: no sum over a hemisphere leaves float's range, and no sky comes near it.
constexpr float kLargestEnvironment = 1e20f;
constexpr std::uint32_t kMakes = kMakesAmbient | kMakesSpecular | kMakesRefracted | kMakesShadow;

// Geometry and source views apart, which the volume speaks of.
std::vector<LWChoice> unusedInputs(const LWFrame& frame, const LWConeTracingDesc& desc) {
    std::vector<LWChoice> unused;
    if (frame.vplCount)
        unused.push_back({"frame.vpls", "not used: technique cone_tracing takes light from RSMs, emissive geometry and the environment only"});
    if (frame.blockerCount) unused.push_back({"frame.blockers", "not used: in technique cone_tracing voxels block light"});
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (frame.lights[l].rsmCount == 0) {
            unused.push_back({"frame.lights", "some have no RSM: technique cone_tracing makes no indirect light of those"});
            break;
        }
    if (desc.extent > 0.0f && frame.focus) unused.push_back({"center", "not used: the grids lie around frame.focus"});
    return unused;
}

std::optional<ConeLightSource> lightOf(const LWFrame& frame, const LWConeTracingDesc& desc) {
    if (desc.shadowLight >= frame.lightCount) return std::nullopt;
    const LWLight& light = frame.lights[desc.shadowLight];
    ConeLightSource source;
    source.isDirectional = light.kind == LW_LIGHT_DIRECTIONAL;
    source.fullAngle = double(desc.shadowAngle);
    for (int a = 0; a < 3; ++a) source.at[a] = source.isDirectional ? -light.direction[a] : light.position[a];
    return source;
}

void checkEnvironment(const LWFrame& frame) {
    for (int c = 0; c < 3; ++c)
        if (frame.environment[c] > kLargestEnvironment)
            fail(LW_ERROR_INVALID_ARGUMENT, "frame.environment[", c, "]: expected a radiance of at most ", kLargestEnvironment, ", got ",
                 frame.environment[c]);
}

class ConeTracingTechnique final : public Technique {
public:
    ConeTracingTechnique(Device& device, const LWConeTracingDesc& desc, int hidden = 0)
        : device_(device),
          desc_(desc),
          hidden_(hidden),
          volume_(std::make_unique<ConeTracingVolume>(device, desc, hidden)),
          passes_(std::make_unique<ConeTracingPasses>(device, desc)) {}

    void update(Executor& executor, const LWFrame& frame) override {
        checkEnvironment(frame);
        volume_->check(frame);
        rsms_.import(executor, frame);
        const bool lost = continuity_.beginLost();
        if (lost) forget();
        volume_->record(executor, frame, rsms_, frame.reset != 0 || lost);
        shadowLight_ = lightOf(frame, desc_);
        choices_ = unusedInputs(frame, desc_);
        for (const LWChoice& choice : volume_->choices(frame)) choices_.push_back(choice);
        states_.purge();
        states_.each([](ConeTracingView& state) { state.startFrame(); });
        if (points_) points_->startFrame();
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "cone_tracing", kMakes);
        const ConeRaysAsked rays = ConeTracingRays::asked(*view, gbuffer, output, desc_, shadowLight_ ? &*shadowLight_ : nullptr);
        ConeTracingView& state = states_.get(view, [&] { return std::make_unique<ConeTracingView>(device_, desc_); });
        state.render(executor, *view, gbuffer, output, *passes_, volume_->world(), rays);
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkPoints(device_, points);
        if (!points_) points_.emplace(device_, coneOptions(desc_));
        points_->render(executor, points, volume_->world());
    }

    void lose() override { continuity_.lose(); }

    // In small grids, as many as there are (an option of the kernels); then in a larger one, where kernels are others.
    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        prewarmIn(executor, kPrewarmedSmall, desc_.cascades);
        if (desc_.size > kSmall) prewarmIn(executor, kPrewarmedLarge, 1);
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    // What memory holds that is kept from frame to frame is not known: voxels, and the tables of cones.
    void forget() {
        volume_ = std::make_unique<ConeTracingVolume>(device_, desc_, hidden_);
        passes_ = std::make_unique<ConeTracingPasses>(device_, desc_);
        points_.reset();
    }

    // Of every source that frames may bring.
    void prewarmIn(Executor& executor, std::uint32_t size, std::uint32_t cascades) {
        LWConeTracingDesc desc = desc_;
        desc.size = size;
        desc.cascades = cascades;
        desc.sparse = 1;
        desc.shadowLight = 0;  // frames here have one light
        desc.source = LW_VOXEL_SOURCE_AUTO;
        for (int hidden = 0; hidden <= 2; ++hidden) {
            if (desc_.source != LW_VOXEL_SOURCE_AUTO && desc_.source != LW_VOXEL_SOURCE_TRIANGLES + hidden) continue;
            ConeTracingTechnique twin(device_, desc, hidden);
            exerciseTechnique(executor, twin, kMakes);
            exercisePoints(executor, twin);
        }
    }

    Device& device_;
    LWConeTracingDesc desc_;
    int hidden_;  // ConeTracingSurfaces'
    Continuity continuity_{device_};
    RsmInput rsms_;
    std::unique_ptr<ConeTracingVolume> volume_;
    std::unique_ptr<ConeTracingPasses> passes_;
    PerView<ConeTracingView> states_;
    std::optional<ConeTracingPoints> points_;  // from the first lwRenderPoints on
    std::optional<ConeLightSource> shadowLight_;  // of the last update, as is
    std::vector<LWChoice> choices_;
};

Report ConeTracingTechnique::report() {
    Report report;
    rsms_.report(report);
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    volume_->report(report);
    ConeTracingView::startReport(report);
    states_.each([&](const ConeTracingView& state) { state.report(report); });
    if (points_) points_->report(report);
    return report;
}

std::vector<DebugView> ConeTracingTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    volume_->addDebugViews(views);
    if (const ConeTracingView* state = states_.find(view)) state->addDebugViews(views);
    return views;
}

std::uint64_t ConeTracingTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + volume_->bytes() + passes_->bytes() + (points_ ? points_->bytes() : 0);
    states_.each([&](const ConeTracingView& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWConeTracingDesc& cones = *static_cast<const LWConeTracingDesc*>(desc);
    return RsmInput::estimateBytes(shape) + ConeTracingVolume::estimateBytes(cones, shape) +
           ConeTracingPasses::estimateBytes(cones) + ConeTracingView::estimateBytes(cones, view, shape.uploads);
}

}  // namespace

const TechniqueEntry& coneTracingEntry() {
    static const TechniqueEntry entry = techniqueEntry<ConeTracingTechnique, LWConeTracingDesc, lwDefaultConeTracing>(
        "cone_tracing", "voxel cone tracing: the scene as lit voxels, followed from each pixel in a few cones", 1, coneTracingParameters(),
        coneTracingSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
