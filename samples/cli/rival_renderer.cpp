#include "rival_renderer.h"

#include <cstddef>

#include "cli.h"
#include "rival.h"

namespace cli {
namespace {

using studio::RivalOptions;

class RivalRenderer final : public IndirectRenderer {
public:
    RivalRenderer(const RivalOptions& options, const RenderInputs& inputs)
        : options_(options),
          rival_(std::make_unique<studio::Rival>(options, inputs.gbuffer().width,
                                                 inputs.gbuffer().height)),
          irradiance_(inputs.gbuffer().width, inputs.gbuffer().height, 3),
          validity_(inputs.gbuffer().width, inputs.gbuffer().height, 1),
          estimatedBytes_(rival_->bytes()) {}

    FrameSample renderFrame(const RenderInputs& inputs, bool) override {
        fitSize(inputs.gbuffer().width, inputs.gbuffer().height);
        const studio::RivalTimes times =
            rival_->render(inputs.scene(), inputs.gbuffer(), irradiance_, validity_);
        FrameSample frame;
        for (const auto& [name, milliseconds] : times.passes)
            frame.passes.push_back({name, milliseconds, 1});
        frame.totalMilliseconds = frame.wallMilliseconds = times.total;
        frame.deviceBytes = rival_->bytes();
        frame.counts = {{"rays", times.rays},
                        {"shadow_rays", times.shadowRays},
                        {"left_over_pixels", times.leftOver},
                        {"processor_us", std::uint64_t(1e3 * times.processor)}};
        return frame;
    }
    const studio::PlanarBuffer& irradiance() const override { return irradiance_; }
    const studio::PlanarBuffer& validity() const override { return validity_; }
    std::uint64_t estimatedBytes() const override { return estimatedBytes_; }
    const LWDeviceInfo* device() const override { return nullptr; }
    DebugPlanes readDebugView(const std::string& name) const override {
        throw UsageError("unknown debug view '" + name + "'; technique rival has none");
    }

private:
    // It remembers nothing of earlier frames but the scene's tables: another size is another rival.
    void fitSize(int width, int height) {
        if (width == irradiance_.width() && height == irradiance_.height()) return;
        rival_ = std::make_unique<studio::Rival>(options_, width, height);
        irradiance_ = studio::PlanarBuffer(width, height, 3);
        validity_ = studio::PlanarBuffer(width, height, 1);
    }

    RivalOptions options_;
    std::unique_ptr<studio::Rival> rival_;
    studio::PlanarBuffer irradiance_, validity_;
    std::uint64_t estimatedBytes_;
};

const double kBounces[] = {1, 2}, kSamples[] = {1, 2, 4, 8, 16}, kPatterns[] = {0, 1, 2, 4, 8};
const char* const kResolutions[] = {"full", "half", "quarter", nullptr};
const char* const kRays[] = {"packets", "single", nullptr};
const double kResolutionSweep[] = {0, 1, 2};

const LWSetting kSettings[] = {{"1 path, raw", "spp=1 filter=off"},
                               {"16 paths, raw", "spp=16 filter=off"},
                               {"16 paths, connected", "spp=16 connect=on"}};

#define FIELD(name) std::uint32_t(offsetof(RivalOptions, name))
const LWParameter kParameters[] = {
    {"bounces", "1: one indirect bounce; 2: the first and the second", LW_PARAMETER_UINT, FIELD(bounces),
     1, 2, 1, nullptr, kBounces, 2, kBounces, 2},
    {"spp", "paths per traced pixel; time grows in proportion", LW_PARAMETER_UINT, FIELD(spp), 1, 1024,
     1, nullptr, nullptr, 0, kSamples, 5},
    {"resolution", "traced on every pixel, every second or every fourth, then up-sampled",
     LW_PARAMETER_ENUM, FIELD(resolution), 0, 2, 0, kResolutions, nullptr, 0, kResolutionSweep, 3},
    {"filter", "edge-aware filter, from two paths on guided by their noise; off: the traced image", LW_PARAMETER_BOOL, FIELD(filter), 0, 1, 1,
     nullptr, nullptr, 0, nullptr, 0},
    {"levels", "of the filter, each doubles its reach; 0: two or three, by resolution", LW_PARAMETER_UINT,
     FIELD(levels), 0, 5, 0, nullptr, nullptr, 0, nullptr, 0},
    {"pattern", "pixels this many apart share sample points, so that rays are coherent; 0: none do",
     LW_PARAMETER_UINT, FIELD(pattern), 0, 8, 0, nullptr, kPatterns, 5, nullptr, 0},
    {"rays", "how rays go to Embree: 16 at a time or one by one", LW_PARAMETER_ENUM, FIELD(rays), 0, 1,
     0, kRays, nullptr, 0, nullptr, 0},
    {"connect", "join paths to what lamps shine on, found from the lamps; twice the rays",
     LW_PARAMETER_BOOL, FIELD(connect), 0, 1, 0, nullptr, nullptr, 0, nullptr, 0},
    {"seed", "of the sample points", LW_PARAMETER_UINT, FIELD(seed), 0, 4294967295.0, 0, nullptr,
     nullptr, 0, nullptr, 0},
};
#undef FIELD

void setDefaults(void* options) {
    *static_cast<RivalOptions*>(options) = RivalOptions{};
}

}  // namespace

const LWTechniqueInfo& rivalInfo() {
    static const LWTechniqueInfo info = {
        sizeof(LWTechniqueInfo),
        sizeof(RivalOptions),
        "rival",
        "path tracing with Embree on the host's cores, not of the library: what to compare with",
        kParameters,
        std::uint32_t(std::size(kParameters)),
        setDefaults,
        0,  // the parameter says it
        kSettings,
        std::uint32_t(std::size(kSettings)),
        0,
        0};
    return info;
}

std::unique_ptr<IndirectRenderer> makeRival(const Parameters& parameters, const RenderInputs& inputs) {
    return std::make_unique<RivalRenderer>(*static_cast<const RivalOptions*>(parameters.descriptor()),
                                           inputs);
}

}  // namespace cli
