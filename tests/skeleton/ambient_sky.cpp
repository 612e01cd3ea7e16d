#include "skeleton/ambient_sky.h"

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "techniques/prewarm.h"

namespace lightwell {
namespace {

class AmbientSky final : public Technique {
public:
    AmbientSky(Device& device, const AmbientSkyDesc& desc)
        : device_(device),
          desc_(desc),
          fill_(device.programs().kernel("ambient_sky", "ambient_sky_fill")) {}

    // Once per frame: what the world part needs. Here that is one value.
    void update(Executor&, const LWFrame& frame) override {
        for (std::size_t c = 0; c < 3; ++c) radiance_.s[c] = desc_.gain * frame.environment[c];
    }

    // Once per view: inputs, passes, outputs. Reads as the algorithm.
    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        if (output.irradiance.format == LW_FORMAT_NONE)
            fail(LW_ERROR_INVALID_ARGUMENT, "output.irradiance: expected an image, got none");
        ViewState& state = states_.get(view, [] { return std::make_unique<ViewState>(); });
        state.gbuffer.import(executor, *view, gbuffer, 0, "gbuffer");
        const Planes irradiance =
            state.irradiance.begin(executor, *view, output.irradiance, 3, "output.irradiance");
        executor.run("ambient_sky.fill", fill_,
                     {(view->width + fill_.width() - 1) / fill_.width(), view->height}, {8, 1},
                     state.gbuffer.position, state.gbuffer.normal, cl_int(view->width),
                     cl_int(view->height), radiance_, irradiance);
        state.irradiance.end(executor);
    }

    // Every kernel that the parameters can need, on inputs of every kind.
    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        AmbientSky twin(device_, desc_);
        exerciseTechnique(executor, twin);
    }

    Report report() override {
        Report report;
        states_.each([&](const ViewState& state) {
            state.gbuffer.report(report);
            state.irradiance.report(report);
        });
        return report;
    }

    std::vector<DebugView> debugViews(const View*) override { return {}; }

    std::uint64_t bytes() const override {
        std::uint64_t total = 0;
        states_.each([&](const ViewState& s) { total += s.gbuffer.bytes() + s.irradiance.bytes(); });
        return total;
    }

private:
    struct ViewState {
        GBufferInput gbuffer;
        OutputTarget irradiance;
    };

    Device& device_;
    AmbientSkyDesc desc_;
    Kernel& fill_;
    cl_float4 radiance_ = {};
    PerView<ViewState> states_;
};

// ---- registration: what the command line and the charts know about the technique

void setDefaults(void* desc) {
    *static_cast<AmbientSkyDesc*>(desc) = {std::uint32_t(sizeof(AmbientSkyDesc)), 1.0f};
}

std::unique_ptr<Technique> create(Device& device, const void* desc) {
    return std::make_unique<AmbientSky>(device, *static_cast<const AmbientSkyDesc*>(desc));
}

std::uint64_t estimateBytes(const void*, const LWViewDesc& view, const FrameShape& shape) {
    return GBufferInput::estimateBytes(view, 0, shape.uploads) + OutputTarget::estimateBytes(view, 3, shape.uploads);
}

const LWParameter kParameters[] = {{"gain", "factor on the sky's radiance", LW_PARAMETER_FLOAT,
                                    std::uint32_t(offsetof(AmbientSkyDesc, gain)), 0.0, 1e6, 1.0,
                                    nullptr, nullptr, 0, nullptr, 0}};

}  // namespace

const TechniqueEntry& ambientSkyEntry() {
    static const TechniqueEntry entry = {{sizeof(LWTechniqueInfo), sizeof(AmbientSkyDesc), "ambient_sky",
                                          "an even sky that nothing hides", kParameters, 1, setDefaults, 0, nullptr, 0, 0, 0},
                                         create,
                                         estimateBytes};
    return entry;
}

}  // namespace lightwell
