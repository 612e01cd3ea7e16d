// Runs a technique on one view, frame after frame, and measures it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lightwell/lightwell.hpp"
#include "parameters.h"
#include "render_inputs.h"

namespace cli {

struct PassFigures {
    std::string name;
    double milliseconds = 0.0;  // median over the measured frames; < 0: unavailable
    std::uint32_t launches = 0;
};

struct FrameFigures {
    std::vector<PassFigures> passes;
    double totalMilliseconds =
        -1.0;  // median, device clock, host's images to host's output; -1: unavailable
    double wallMilliseconds = -1.0;  // median, host clock, lwUpdate to the end of lwFinish
    std::uint64_t deviceBytes = 0, hostCopyBytes = 0, estimatedBytes = 0;
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    std::vector<std::pair<std::string, std::string>> choices;
};

struct DebugPlanes {
    std::uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> values;  // planes of width * height
    const float* plane(std::uint32_t channel) const {
        return values.data() + std::size_t(channel) * width * height;
    }
};

class FrameRunner {
public:
    FrameRunner(const lightwell::Device& device, const std::string& technique,
                const Parameters& parameters, const RenderInputs& inputs);

    // `warmUpCount` unmeasured frames, in which caches and clocks settle, then `count` measured ones.
    FrameFigures run(int warmUpCount, int count);
    const studio::PlanarBuffer& irradiance() const { return irradiance_; }
    const studio::PlanarBuffer& validity() const { return validity_; }
    // UsageError listing the views when there is none of this name.
    DebugPlanes readDebugView(const std::string& name) const;

private:
    void renderFrame();

    lightwell::Device device_;
    const RenderInputs& inputs_;
    lightwell::View view_;
    lightwell::Technique technique_;
    studio::PlanarBuffer irradiance_, validity_;
    std::uint64_t estimatedBytes_ = 0, frameIndex_ = 0;
};

}  // namespace cli
