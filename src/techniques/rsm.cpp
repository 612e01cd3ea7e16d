// Frame part, per-view state, report and registration; the table of parameters is rsm_parameters.cpp's.
#include "techniques/rsm.h"

#include <algorithm>
#include <optional>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "inputs/rsm_input.h"
#include "passes/interleaved_gather.h"
#include "passes/joint_bilateral.h"
#include "passes/vpl_sampling.h"
#include "techniques/prewarm.h"
#include "techniques/rsm_parameters.h"

namespace lightwell {
namespace {

VplSamplingOptions samplingOptions(const LWRsmDesc& desc) {
    VplSamplingOptions options;
    options.count = desc.vpls;
    options.uniform = desc.sampling == LW_SAMPLING_UNIFORM;
    options.subsets = desc.interleave * desc.interleave;
    options.seed = desc.seed;
    return options;
}

// A list of any length takes the same kernels in the same groups.
constexpr std::uint32_t kPrewarmVpls = 1024;

bool halfResolution(const LWRsmDesc& desc) { return desc.resolution == LW_RESOLUTION_HALF; }
std::uint32_t gatheredPixels(const LWRsmDesc& desc, std::uint32_t along) {
    return halfResolution(desc) ? JointBilateral::halved(along) : along;
}
bool filters(const LWRsmDesc& desc) { return desc.filter != 0 && desc.interleave > 1; }

// What the host gave and this technique does not read: said in the stats, so that nobody waits for its light.
std::vector<LWChoice> unusedInputs(const LWFrame& frame) {
    constexpr const char* kReason = "not used: technique rsm takes light from RSMs and authored VPLs only";
    std::vector<LWChoice> unused;
    if (frame.sourceViewCount) unused.push_back({"frame.sourceViews", kReason});
    if (frame.geometry) unused.push_back({"frame.geometry", kReason});
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

constexpr const char* kSkips = "VPLs that cannot light a tile of pixels are skipped there";
constexpr const char* kSkipsNone = "none: a list of more than 16384 slots, of which every pixel takes its whole share";
static_assert(VplTiles::kMostSlots == 16384, "kSkipsNone names it");

class RsmTechnique final : public Technique {
public:
    RsmTechnique(Device& device, const LWRsmDesc& desc)
        : device_(device), desc_(desc), sampling_(device, samplingOptions(desc)), gather_(device, desc.interleave) {
        if (halfResolution(desc)) bilateral_.emplace(device);  // a program built for nothing is also never cached
    }

    void update(Executor& executor, const LWFrame& frame) override {
        rsms_.import(executor, frame);
        sampling_.record(executor, rsms_, frame.vpls, frame.vplCount);
        unused_ = unusedInputs(frame);
        states_.purge();
        states_.each([](ViewState& state) { state.rendered = false; });
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        checkOutputs(output, *view);
        ViewState& state = states_.get(view, [&] { return std::make_unique<ViewState>(device_, desc_, *view); });
        state.gbuffer.import(executor, *view, gbuffer, 0, "gbuffer");
        // Should a later step fail, the images of the frame before are gone.
        state.lastGathered = state.lastFiltered = Planes{};
        state.rendered = true;
        const Planes irradiance = state.irradiance.begin(executor, *view, output.irradiance, 3, "output.irradiance");
        const Planes validity = state.validity.begin(executor, *view, output.validity, 1, "output.validity");
        if (irradiance) light(executor, state, irradiance);
        if (validity) gather_.recordValidity(executor, state.gbuffer.position, state.gbuffer.normal, validity);
        state.irradiance.end(executor);
        state.validity.end(executor);
    }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        // A twin, so that this technique's frame stays as it is; kernels belong to the device.
        LWRsmDesc desc = desc_;
        desc.vpls = std::min(desc.vpls, kPrewarmVpls);
        RsmTechnique twin(device_, desc);
        exerciseTechnique(executor, twin);
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

    // Images of one view that lie between the passes.
    struct ViewState {
        ViewState(Device& device, const LWRsmDesc& desc, const View& view);
        std::uint64_t bytes() const;
        static std::uint64_t imageBytes(const LWRsmDesc& desc, std::uint32_t width, std::uint32_t height);

        GBufferInput gbuffer;
        OutputTarget irradiance, validity;
        PlanarImage gathered, filtered, halfPosition, halfNormal;
        std::uint32_t gatheredWidth, gatheredHeight;  // at most
        VplTiles tiles;
        Buffer counts;  // rejected pixels, up-sampling fallbacks, saturated pixels
        static constexpr std::size_t kCountBytes = 3 * sizeof(cl_int);
        Planes lastGathered, lastFiltered;  // empty where the last frame had no irradiance
        bool rendered = false;              // since the last update
    };

private:
    void checkOutputs(const LWOutput& output, const View& view) const;
    void light(Executor& executor, ViewState& state, const Planes& irradiance);

    Device& device_;
    LWRsmDesc desc_;
    RsmInput rsms_;
    VplSampling sampling_;
    InterleavedGather gather_;
    std::optional<JointBilateral> bilateral_;  // half resolution only
    PerView<ViewState> states_;
    std::vector<LWChoice> unused_;  // of the last update
};

RsmTechnique::ViewState::ViewState(Device& device, const LWRsmDesc& desc, const View& view)
    : gatheredWidth(gatheredPixels(desc, view.maxWidth)), gatheredHeight(gatheredPixels(desc, view.maxHeight)),
      counts(device, kCountBytes, "counts of a view") {
    const bool half = halfResolution(desc);
    const std::uint32_t width = gatheredWidth, height = gatheredHeight;
    if (half || filters(desc)) gathered = PlanarImage(device, width, height, 3, "gathered irradiance");
    if (half && filters(desc)) filtered = PlanarImage(device, width, height, 3, "filtered irradiance");
    if (half) {
        halfPosition = PlanarImage(device, width, height, 3, "half-resolution positions");
        halfNormal = PlanarImage(device, width, height, 3, "half-resolution normals");
    }
}

std::uint64_t RsmTechnique::ViewState::imageBytes(const LWRsmDesc& desc, std::uint32_t width, std::uint32_t height) {
    const bool half = halfResolution(desc);
    const std::uint64_t w = paddedWidth(gatheredPixels(desc, width)), h = gatheredPixels(desc, height);
    const std::uint64_t images = (half || filters(desc) ? 1u : 0u) + (half && filters(desc) ? 1u : 0u) + (half ? 2u : 0u);
    return images * 3 * w * h * sizeof(float) + kCountBytes;
}

void RsmTechnique::checkOutputs(const LWOutput& output, const View& view) const {
    const std::pair<const LWImage*, const char*> unsupported[] = {{&output.ambientOcclusion, "ambientOcclusion"},
                                                                  {&output.specularRadiance, "specularRadiance"},
                                                                  {&output.shadow, "shadow"}};
    for (const auto& [image, name] : unsupported)
        if (rawEnum(image->format) != LW_FORMAT_NONE)
            fail(LW_ERROR_UNSUPPORTED, "output.", name, ": technique rsm makes irradiance and validity only");
    if (rawEnum(output.irradiance.format) == LW_FORMAT_NONE && rawEnum(output.validity.format) == LW_FORMAT_NONE)
        fail(LW_ERROR_INVALID_ARGUMENT, "output: expected irradiance or validity, got neither");
    OutputTarget::check(device_, view, output.irradiance, 3, "output.irradiance");
    OutputTarget::check(device_, view, output.validity, 1, "output.validity");
}

void RsmTechnique::light(Executor& executor, ViewState& state, const Planes& irradiance) {
    Planes position = state.gbuffer.position, normal = state.gbuffer.normal;
    const bool half = halfResolution(desc_), filter = filters(desc_);
    executor.fill("interleaved_gather.counts", state.counts, 0, 0, state.counts.bytes());
    if (half) {
        const std::uint32_t w = JointBilateral::halved(position.width), h = JointBilateral::halved(position.height);
        const Planes halfPosition = state.halfPosition.planes(w, h), halfNormal = state.halfNormal.planes(w, h);
        bilateral_->recordDownsample(executor, position, normal, halfPosition, halfNormal);
        position = halfPosition;
        normal = halfNormal;
    }
    const Planes gathered = half || filter ? state.gathered.planes(position.width, position.height) : irradiance;
    state.tiles.reserve(device_, state.gatheredWidth, state.gatheredHeight, sampling_.order(), desc_.interleave);
    gather_.recordCull(executor, position, normal, sampling_.vpls(), sampling_.order(), state.tiles);
    gather_.recordGather(executor, position, normal, sampling_.vpls(), sampling_.order(), state.tiles.masks(), gathered,
                         state.counts);
    Planes lit = gathered;
    if (filter) {
        lit = half ? state.filtered.planes(position.width, position.height) : irradiance;
        gather_.recordFilter(executor, position, normal, gathered, lit);
    }
    if (half)
        bilateral_->recordUpsample(executor, state.gbuffer.position, state.gbuffer.normal, position, normal, lit,
                                  irradiance, state.counts);
    state.lastGathered = gathered;
    state.lastFiltered = lit;
}

Report RsmTechnique::report() {
    Report report;
    rsms_.report(report);
    // With every texel a VPL, the list also holds the dark padding of the maps' rows.
    const std::uint32_t padding = desc_.vpls == 0 ? rsms_.texels.width - rsms_.texelCount : 0;
    report.counts.push_back({"vpls", sampling_.vplCount() - padding});
    for (const LWChoice& choice : unused_) report.choose(choice.name, choice.reason);
    report.counts.push_back({"rejected_pixels", 0});
    report.counts.push_back({"upsample_fallbacks", 0});
    report.counts.push_back({"saturated_pixels", 0});
    states_.each([&](const ViewState& state) {
        if (!state.rendered) return;
        state.gbuffer.report(report);
        state.irradiance.report(report);
        state.validity.report(report);
        if (!state.lastGathered) return;
        report.choose("tiles", VplTiles::skips(sampling_.order()) ? kSkips : kSkipsNone);
        report.read(device_, "rejected_pixels", state.counts, 0);
        report.read(device_, "upsample_fallbacks", state.counts, sizeof(cl_int));
        report.read(device_, "saturated_pixels", state.counts, 2 * sizeof(cl_int));
    });
    return report;
}

std::vector<DebugView> RsmTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (sampling_.vpls())
        views.push_back({"vpls", "one column per slot: position xyz (m), unit normal xyz, flux rgb (W), area (m^2)",
                         sampling_.debugShape(),
                         [this](Executor& executor, const Planes& planes) { sampling_.recordPlanes(executor, planes); }});
    if (ViewState* state = states_.find(view); state && state->lastGathered) {
        views.push_back({"position", "world position (m)", state->gbuffer.position, {}});
        views.push_back({"normal", "world normal as the host gave it", state->gbuffer.normal, {}});
        views.push_back({"gathered", "irradiance before the filter (W/m^2)", state->lastGathered, {}});
        if (filters(desc_)) views.push_back({"filtered", "irradiance after the filter (W/m^2)", state->lastFiltered, {}});
    }
    return views;
}

std::uint64_t RsmTechnique::ViewState::bytes() const {
    return gbuffer.bytes() + irradiance.bytes() + validity.bytes() + gathered.bytes() + filtered.bytes() +
           halfPosition.bytes() + halfNormal.bytes() + tiles.bytes() + counts.bytes();
}

std::uint64_t RsmTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + sampling_.bytes();
    states_.each([&](const ViewState& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

void setDefaults(void* desc) { lwDefaultRsm(static_cast<LWRsmDesc*>(desc)); }

std::unique_ptr<Technique> create(Device& device, const void* desc) {
    return std::make_unique<RsmTechnique>(device, *static_cast<const LWRsmDesc*>(desc));
}

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWRsmDesc& rsm = *static_cast<const LWRsmDesc*>(desc);
    return RsmInput::estimateBytes(shape) + VplSampling::estimateBytes(samplingOptions(rsm), shape) +
           GBufferInput::estimateBytes(view, 0, shape.uploads) + OutputTarget::estimateBytes(view, 3, shape.uploads) +
           OutputTarget::estimateBytes(view, 1, shape.uploads) +
           RsmTechnique::ViewState::imageBytes(rsm, view.maxWidth, view.maxHeight) +
           VplTiles::estimateBytes(gatheredPixels(rsm, view.maxWidth), gatheredPixels(rsm, view.maxHeight),
                                   VplSampling::orderOf(samplingOptions(rsm), shape), rsm.interleave);
}

TechniqueEntry makeEntry() {
    TechniqueEntry entry{};
    entry.info.structSize = sizeof(LWTechniqueInfo);
    entry.info.descSize = sizeof(LWRsmDesc);
    entry.info.name = "rsm";
    entry.info.summary = "virtual point lights from reflective shadow maps, gathered without visibility";
    entry.info.parameters = rsmParameters().data();
    entry.info.parameterCount = std::uint32_t(rsmParameters().size());
    entry.info.setDefaults = setDefaults;
    entry.info.bounces = 1;
    entry.info.settings = rsmSettings().data();
    entry.info.settingCount = std::uint32_t(rsmSettings().size());
    entry.create = create;
    entry.estimateBytes = estimateBytes;
    return entry;
}

}  // namespace

const TechniqueEntry& rsmEntry() {
    static const TechniqueEntry entry = makeEntry();
    return entry;
}

}  // namespace lightwell
