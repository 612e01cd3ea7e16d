#include "instant_radiosity_renderer.h"

#include <algorithm>
#include <cstddef>

#include "cli.h"
#include "instant_radiosity.h"
#include "vpl_view.h"

namespace cli {
namespace {

using studio::InstantRadiosityOptions;

class InstantRadiosityRenderer final : public IndirectRenderer {
public:
    InstantRadiosityRenderer(const InstantRadiosityOptions& options, const RenderInputs& inputs)
        : radiosity_(options) {
        fitSize(inputs.gbuffer());
        const std::uint64_t lights = inputs.scene().lights().size();
        estimatedBytes_ = lights * options.vpls * sizeof(studio::VplRecord);
    }

    FrameSample renderFrame(const RenderInputs& inputs, bool) override {
        fitSize(inputs.gbuffer());
        const studio::InstantRadiosityTimes times =
            radiosity_.render(inputs.scene(), inputs.gbuffer(), irradiance_, validity_);
        FrameSample frame;
        for (const auto& [name, milliseconds] : times.passes)
            frame.passes.push_back({name, milliseconds, 1});
        frame.totalMilliseconds = frame.wallMilliseconds = times.total;
        frame.deviceBytes = radiosity_.bytes();
        frame.counts = {{"vpls", radiosity_.vpls().size()},
                        {"photons", times.photons},
                        {"shadow_rays", times.shadowRays},
                        {"processor_us", std::uint64_t(1e3 * times.processor)}};
        return frame;
    }
    const studio::PlanarBuffer& irradiance() const override { return irradiance_; }
    const studio::PlanarBuffer& validity() const override { return validity_; }
    std::uint64_t estimatedBytes() const override { return estimatedBytes_; }
    const LWDeviceInfo* device() const override { return nullptr; }
    bool hasDebugView(const std::string& name) const override { return name == kVplView; }
    DebugPlanes readDebugView(const std::string& name) const override {
        if (name != kVplView)
            throw UsageError("unknown debug view '" + name + "'; valid: " + std::string(kVplView));
        const std::vector<studio::VplRecord>& vpls = radiosity_.vpls();
        // At least one column, of nothing: a picture without pixels cannot be written.
        const std::size_t count = std::max<std::size_t>(vpls.size(), 1);
        DebugPlanes planes{std::uint32_t(count), 1, kVplChannels, {}};
        planes.values.assign(count * kVplChannels, 0.0f);
        for (std::size_t i = 0; i < vpls.size(); ++i) {
            const studio::VplRecord& v = vpls[i];
            const float values[kVplChannels] = {v.position.x, v.position.y, v.position.z, v.normal.x,
                                                v.normal.y,   v.normal.z,   v.flux.x,     v.flux.y,
                                                v.flux.z,     v.area};
            for (std::uint32_t c = 0; c < kVplChannels; ++c) planes.values[c * count + i] = values[c];
        }
        return planes;
    }

private:
    void fitSize(const studio::GBuffer& gbuffer) {
        if (gbuffer.width == irradiance_.width() && gbuffer.height == irradiance_.height()) return;
        irradiance_ = studio::PlanarBuffer(gbuffer.width, gbuffer.height, 3);
        validity_ = studio::PlanarBuffer(gbuffer.width, gbuffer.height, 1);
    }

    studio::InstantRadiosity radiosity_;
    studio::PlanarBuffer irradiance_, validity_;
    std::uint64_t estimatedBytes_ = 0;
};

const double kCounts[] = {1, 20, 200}, kOffOn[] = {0, 1};

#define FIELD(name) std::uint32_t(offsetof(InstantRadiosityOptions, name))
const LWParameter kParameters[] = {
    {"vpls", "photons traced from each light; time grows in proportion", LW_PARAMETER_UINT, FIELD(vpls),
     1, 1048576, 200, nullptr, nullptr, 0, kCounts, 3},
    {"shadows", "a ray for each pair of pixel and VPL; off: VPLs shine through everything",
     LW_PARAMETER_BOOL, FIELD(shadows), 0, 1, 0, nullptr, nullptr, 0, kOffOn, 2},
    {"seed", "turns the pattern of directions, which is the same in every frame", LW_PARAMETER_UINT,
     FIELD(seed), 0, 4294967295.0, 0, nullptr, nullptr, 0, nullptr, 0},
};
#undef FIELD

void setDefaults(void* options) {
    *static_cast<InstantRadiosityOptions*>(options) = InstantRadiosityOptions{};
}

}  // namespace

const LWTechniqueInfo& instantRadiosityInfo() {
    static const LWTechniqueInfo info = [] {
        LWTechniqueInfo made = lightwell::make<LWTechniqueInfo>();
        made.descSize = sizeof(InstantRadiosityOptions);
        made.name = "instant_radiosity";
        made.summary = "photons traced with Embree as VPLs, on the host's cores, not of the library: what to "
                       "compare with";
        made.parameters = kParameters;
        made.parameterCount = std::uint32_t(std::size(kParameters));
        made.setDefaults = setDefaults;
        made.bounces = 1;
        return made;
    }();
    return info;
}

std::unique_ptr<IndirectRenderer> makeInstantRadiosity(const Parameters& parameters,
                                                       const RenderInputs& inputs) {
    return std::make_unique<InstantRadiosityRenderer>(
        *static_cast<const InstantRadiosityOptions*>(parameters.descriptor()), inputs);
}

}  // namespace cli
