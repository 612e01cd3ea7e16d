// A technique of the library on an OpenCL device, frame after frame.
#pragma once

#include "frame_vpls.h"
#include "indirect_renderer.h"

namespace cli {

// A frame's statistics, and its time on the host's clock.
FrameSample describeFrame(const LWStats& stats, double wallMilliseconds);

class LibraryRenderer final : public IndirectRenderer {
public:
    LibraryRenderer(const lightwell::Device& device, const Parameters& parameters,
                    const RenderInputs& inputs, Quantity quantity = Quantity::Irradiance,
                    float roughness = 0.5f);

    // A frame that was refused half-way leaves commands that read its inputs, which go next.
    ~LibraryRenderer() override;
    LibraryRenderer(const LibraryRenderer&) = delete;
    LibraryRenderer& operator=(const LibraryRenderer&) = delete;

    FrameSample renderFrame(const RenderInputs& inputs, bool reset) override;
    const studio::PlanarBuffer& irradiance() const override { return irradiance_; }
    const studio::PlanarBuffer& validity() const override { return validity_; }
    std::uint64_t estimatedBytes() const override { return estimatedBytes_; }
    const LWDeviceInfo* device() const override { return &info_; }
    bool hasDebugView(const std::string& name) const override;
    DebugPlanes readDebugView(const std::string& name) const override;

private:
    void fitSize(int width, int height);
    LWOutput describeOutput();
    void fillRoughness(int width, int height);
    void render(LWGBuffer gbuffer);
    void spreadShare();

    lightwell::Device device_;
    LWDeviceInfo info_{};
    lightwell::View view_;
    std::vector<lightwell::View> sources_;  // of the further source views
    Descriptor descriptor_;
    bool tellsRsmVersions_;
    lightwell::Technique technique_;
    Quantity quantity_;
    FrameVpls vpls_;
    studio::PlanarBuffer irradiance_, validity_, share_, roughness_;
    float roughnessOfAll_;
    std::uint64_t estimatedBytes_ = 0, frameIndex_ = 0;
};

}  // namespace cli
