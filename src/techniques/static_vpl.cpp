// Frame part, report and registration; the table of parameters is static_vpl_parameters.cpp's. A few lines over 300:
// what a frame records is one algorithm, which is to be read in one place.
#include "techniques/static_vpl.h"

#include <optional>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/static_vpl_input.h"
#include "passes/light_list.h"
#include "passes/phantom_vpl.h"
#include "passes/static_vpl_light.h"
#include "passes/static_vpl_weights.h"
#include "passes/vpl_sampling.h"
#include "techniques/prewarm.h"
#include "techniques/static_vpl_parameters.h"
#include "techniques/static_vpl_phantoms.h"
#include "techniques/static_vpl_shadows.h"
#include "techniques/static_vpl_view.h"
#include "techniques/technique_entry.h"
#include "techniques/vpl_points.h"

namespace lightwell {
namespace {

// Squared distance within which one place's look prevails in a phantom, as a share of the places'
// squared diagonal. The source's code has 0.005 m^2, which is this share in a room of 5 m. Smaller: a
// phantom that passes a place takes its look with a jerk. Larger: the look of all is mixed everywhere.
constexpr double kNearness = 2e-4;

InterleavedOptions interleavedOptions(const LWStaticVplDesc& desc) {
    InterleavedOptions options;
    options.interleave = desc.interleave;
    options.filter = desc.filter != 0;
    options.halvings = std::uint32_t(desc.resolution);
    options.doubtful = desc.visibility == LW_VISIBILITY_STRICT;
    options.history.frames = 0;  // nothing in a frame differs by chance from the last one's
    return options;
}

bool isShadowed(const LWStaticVplDesc& desc) {
    return desc.visibility != LW_VISIBILITY_NONE;
}

LightListOptions listOptions(const LWStaticVplDesc& desc) {
    LightListOptions options;
    options.relative = !(desc.cullAbsolute > 0.0f);
    options.threshold = options.relative ? desc.cullRelative : desc.cullAbsolute;
    options.hysteresis = desc.hysteresis;
    // Shadowed ones in their own order: their clusters are dealt out, not this list.
    options.subsets = isShadowed(desc) ? 1 : desc.interleave * desc.interleave;
    options.lights = desc.lights;
    return options;
}

// What occludes, and what the host gave and this technique does not read.
std::vector<LWChoice> inputChoices(const LWFrame& frame, const StaticVplShadows* shadows) {
    constexpr const char* kReason =
        "not used: technique static_vpl takes light from the frame's lights by its static VPLs only";
    std::vector<LWChoice> unused;
    if (shadows) unused = shadows->choices(frame);
    if (frame.vplCount) unused.push_back({"frame.vpls", kReason});
    if (frame.sourceViewCount) unused.push_back({"frame.sourceViews", kReason});
    if (frame.geometry && !shadows) unused.push_back({"frame.geometry", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    return unused;
}

class StaticVplTechnique final : public Technique {
public:
    StaticVplTechnique(Device& device, const LWStaticVplDesc& desc)
        : device_(device),
          desc_(desc),
          phantoms_(desc.variant == LW_STATIC_VPL_PHANTOM),
          weights_(device, desc.comparisons),
          light_(device),
          phantom_(device),
          list_(device, listOptions(desc)),
          gather_(device, desc.interleave, interleavedOptions(desc).doubtful) {
        if (interleavedOptions(desc).halvings) bilateral_.emplace(device);
        if (isShadowed(desc)) shadows_.emplace(device, desc);
    }

    void update(Executor& executor, const LWFrame& frame) override {
        StaticVplInput::check(frame);
        phantoms_.check(device_, frame);
        if (shadows_) shadows_->check(frame);
        const bool lost = continuity_.beginLost(), restart = lost || frame.reset != 0;
        phantoms_.import(executor, frame);
        input_.import(executor, frame, desc_.unitArea, desc_.automaticWeights != 0,
                      phantoms_.phantoms());
        const lw_static_frame& scene = input_.frame();
        weights_.reserve(frame.staticVplCount, input_.anyAutomatic());
        if (restart) weights_.forget();
        if (restart || phantoms_.changed()) phantom_.forget();
        if (input_.anyAutomatic()) weights_.record(executor, input_.memory(), scene);
        light_.record(executor, input_.memory(), scene, weights_.areas());
        const std::uint32_t spots = std::uint32_t(scene.phantomCount),
                            others = PhantomVpl::others(spots, desc_.bounces > 1);
        list_.reserve(frame.staticVplCount, others, input_.bakedReceivers() ? 2 : 1);
        list_.recordCull(executor, input_.memory(), scene, light_.lit(), restart);
        phantom_.record(executor, input_.memory(), scene, light_.lit(), phantoms_.texels(),
                        phantomOptions(), list_);
        if (shadows_) shadows_->update(executor, frame, list_, others - spots, restart, lost);
        isListed_ = false;

        choices_ = inputChoices(frame, passes().shadows);
        for (const LWChoice& choice : phantoms_.choices(frame)) choices_.push_back(choice);
        states_.purge();
        states_.each([&](StaticVplView& state) { state.startFrame(restart); });
        if (points_) points_->startFrame();
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "static_vpl");
        StaticVplView& state = states_.get(view, [&] {
            return std::make_unique<StaticVplView>(device_, interleavedOptions(desc_), *view);
        });
        state.render(executor, *view, gbuffer, output, passes());
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkPoints(device_, points);
        if (shadows_)
            return shadows_->renderPoints(executor, list_.lists() > 1 && points.output.baked ? 1 : 0,
                                          points);
        if (!points_) points_.emplace(device_);
        points_->render(executor, points, points.output.baked ? list_.baked() : list_.vpls(),
                        list_.order());
    }

    std::uint32_t listedLights() const override { return desc_.lights; }
    void readLightList(Executor& executor, LWListedLight* lights) override {
        static_assert(sizeof(LWListedLight) == sizeof(lw_listed_light),
                      "LWListedLight is copied as it is");
        if (!isListed_) list_.recordLights(executor, input_.diagonal());
        isListed_ = true;
        executor.read("light_list.read", list_.listed().get(), 0, desc_.lights * sizeof(LWListedLight),
                      lights);
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override;
    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    StaticVplPasses passes() {
        return {gather_, bilateral_ ? &*bilateral_ : nullptr, list_, shadows_ ? &*shadows_ : nullptr};
    }
    lw_phantom_options phantomOptions() const {
        lw_phantom_options options{};
        options.eps = float(kNearness * input_.diagonal() * input_.diagonal());
        options.smoothing = desc_.smoothing;
        options.reflectance = desc_.averageReflectance;
        options.area = desc_.secondArea;
        options.distance = desc_.secondDistance > 0.0f ? desc_.secondDistance : float(input_.meanSide());
        options.opposite = desc_.bounces > 1 ? 1 : 0;
        return options;
    }

    Device& device_;
    LWStaticVplDesc desc_;
    Continuity continuity_{device_};
    StaticVplPhantoms phantoms_;
    StaticVplInput input_;
    StaticVplWeights weights_;
    StaticVplLight light_;
    PhantomVpl phantom_;
    LightList list_;
    bool isListed_ = false;  // the frame's lights are made
    InterleavedGather gather_;
    std::optional<JointBilateral> bilateral_;  // reduced resolution only
    std::optional<StaticVplShadows> shadows_;  // with visibility only
    PerView<StaticVplView> states_;
    std::optional<VplPoints> points_;  // from the first lwRenderPoints on
    std::vector<LWChoice> choices_;    // of the last update
};

// Twins, so that this technique's frame stays as it is; kernels belong to the device. Automatic weights
// depend on the frame, as do, of shadows, what occludes and whether VPLs share what they see.
void StaticVplTechnique::prewarm(Executor& executor, const std::shared_ptr<View>&) {
    LWStaticVplDesc desc = desc_;
    desc.automaticWeights = 1;
    desc.bounces = 2;
    desc.lights = 1;  // the exercise's VPLs are more: they have to be merged
    const auto exercise = [&] {
        StaticVplTechnique twin(device_, desc);
        exerciseTechnique(executor, twin, 0, true);
        exercisePoints(executor, twin);
    };
    if (!shadows_) exercise();
    for (int shared = 0; shadows_ && shared < 2; ++shared) {
        desc.clusters = std::uint32_t(shared);
        if (desc_.occluders == LW_OCCLUDERS_AUTO)
            desc.occluders = shared ? LW_OCCLUDERS_SURFELS : LW_OCCLUDERS_TRIANGLES;
        exercise();
    }
    desc.visibility = LW_VISIBILITY_NONE;  // of which the list knows nothing
    StaticVplTechnique twin(device_, desc);
    LWStaticVpl places[2] = {};
    for (LWStaticVpl& place : places) place.normal[1] = 1.0f;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.staticVpls = places;
    frame.staticVplCount = 2;
    LWListedLight light;
    for (const double x : {0.0, 1.0}) {  // and from another origin
        frame.worldOrigin[0] = x;
        executor.setWorldOrigin({x, 0.0, 0.0});
        twin.update(executor, frame);
        twin.readLightList(executor, &light);
    }
    executor.setWorldOrigin({});
    device_.finish();
}

Report StaticVplTechnique::report() {
    Report report;
    const lw_static_frame& scene = input_.frame();
    report.counts.push_back({"static_vpls", std::uint64_t(scene.count)});
    report.counts.push_back({"kept_vpls", 0});
    if (input_.memory())
        report.read(device_, "kept_vpls", input_.memory(), LW_FRAME_KEPT * sizeof(cl_int));
    report.counts.push_back({"phantom_vpls", std::uint64_t(scene.phantomCount)});
    report.counts.push_back({"vpls", std::uint64_t(list_.order().count)});
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    for (const char* name : {"rejected_pixels", "upsample_fallbacks", "saturated_pixels"})
        report.counts.push_back({name, 0});
    if (shadows_) shadows_->report(report);
    states_.each([&](const StaticVplView& state) { state.report(report, passes().order()); });
    if (points_) points_->report(report);
    return report;
}

std::vector<DebugView> StaticVplTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (list_.vpls()) {
        views.push_back(
            {"vpls", "one column per slot: position xyz (m), unit normal xyz, flux rgb (W), area (m^2)",
             VplSampling::debugShape(list_.order()), [this](Executor& executor, const Planes& planes) {
                 VplSampling(device_, {}).recordPlanes(executor, list_.vpls(), planes);
             }});
        Planes lit;
        lit.memory = light_.lit().get();
        lit.width = std::uint32_t(input_.frame().count);
        lit.height = 1;
        lit.rowStride = lit.planeStride = input_.frame().stride;
        lit.count = LW_LIT_PLANES;
        views.push_back({"static_vpls",
                         "one column per static VPL, before culling: flux rgb (W), flux for baked "
                         "receivers rgb (W), area (m^2)",
                         lit,
                         {}});
        if (shadows_) shadows_->addDebugViews(views);
    }
    if (const StaticVplView* state = states_.find(view)) state->addDebugViews(views);
    return views;
}

std::uint64_t StaticVplTechnique::bytes() const {
    std::uint64_t total = phantoms_.bytes() + input_.bytes() + weights_.bytes() + light_.bytes() +
                          phantom_.bytes() + list_.bytes() + (shadows_ ? shadows_->bytes() : 0) +
                          (points_ ? points_->bytes() : 0);
    states_.each([&](const StaticVplView& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWStaticVplDesc& own = *static_cast<const LWStaticVplDesc*>(desc);
    const bool phantoms = own.variant == LW_STATIC_VPL_PHANTOM;
    const std::uint32_t places = shape.staticVplCount, spots = phantoms ? shape.aimedSpots : 0,
                        others = PhantomVpl::others(spots, own.bounces > 1), opposite = others - spots;
    const LightListOptions options = listOptions(own);
    const std::uint64_t shadows =
        isShadowed(own) ? StaticVplShadows::estimateBytes(own, others, opposite, shape) : 0;
    const lw_subset_order order = isShadowed(own)
                                      ? StaticVplShadows::orderOf(own, places + others, opposite)
                                      : LightList::orderOf(options, places, others);
    return shadows + StaticVplInput::estimateBytes(shape, phantoms) +
           StaticVplWeights::estimateBytes(places) + StaticVplLight::estimateBytes(places) +
           PhantomVpl::estimateBytes(spots) + (phantoms ? StaticVplPhantoms::estimateBytes(shape) : 0) +
           LightList::estimateBytes(options, places, others, shape.bakedReceivers ? 2 : 1) +
           StaticVplView::estimateBytes(interleavedOptions(own), view, shape, order);
}

}  // namespace

const TechniqueEntry& staticVplEntry() {
    static const TechniqueEntry entry =
        techniqueEntry<StaticVplTechnique, LWStaticVplDesc, lwDefaultStaticVpl>(
            "static_vpl",
            "virtual point lights at places that the host chose, lit by its lights past soft spheres", 1,
            staticVplParameters(), staticVplSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
