// Whatever makes indirect light of a view, behind one interface: the library's techniques on a device
// and the host's own (host_techniques.h). Commands, charts and sequences drive either without knowing which it
// is.
//
//     Parameters parameters("rsm");  parameters.set("vpls=1024");
//     const auto renderer = makeRenderer(parameters, inputs, deviceOptions);
//     const FrameFigures figures = measure(*renderer, inputs, 3, 9);   // one still view, or
//     const FrameSample frame = renderer->renderFrame(inputsOfThisFrame);   // a sequence
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lightwell/lightwell.hpp"
#include "parameters.h"
#include "quantity.h"
#include "render_inputs.h"

namespace cli {

struct PassTime {
    std::string name;           // once per frame; launches of one name are summed
    double milliseconds = 0.0;  // < 0: unavailable (a queue without profiling)
    std::uint32_t launches = 0;
};

// One frame as measured.
struct FrameSample {
    std::vector<PassTime> passes;     // in order of their first launch
    double totalMilliseconds = -1.0;  // host's images to host's output; -1: unavailable
    double wallMilliseconds = -1.0;   // the same on the host's clock
    std::uint64_t deviceBytes = 0, hostCopyBytes = 0;
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

class IndirectRenderer {
public:
    virtual ~IndirectRenderer() = default;

    // Renders the next frame of a sequence and waits for it. Inputs may change from frame to frame
    // (camera, lights, objects), their size up to that of the first inputs (dynamic resolution); `reset`
    // forgets what a technique remembers of frames before.
    virtual FrameSample renderFrame(const RenderInputs& inputs, bool reset = false) = 0;

    // Of the last frame: three planes of W/m^2, one plane of 0..1.
    virtual const studio::PlanarBuffer& irradiance() const = 0;
    virtual const studio::PlanarBuffer& validity() const = 0;

    // What lwEstimateMemory, or the host's own sum, said beforehand.
    virtual std::uint64_t estimatedBytes() const = 0;
    // What it runs on; null: the host's own cores, without an OpenCL device.
    virtual const LWDeviceInfo* device() const = 0;
    // Of the last frame.
    virtual bool hasDebugView(const std::string&) const { return false; }
    // UsageError listing the views when there is none of this name.
    virtual DebugPlanes readDebugView(const std::string& name) const = 0;
};

struct DeviceOptions {
    std::string device;       // as openDevice takes it; "": by LIGHTWELL_DEVICE, else the best
    std::uint32_t width = 0;  // lanes per work-item; 0: by probe
    // What is asked of the technique. Radiance of other kinds stands in irradiance(); ambient occlusion and
    // shadow (1 = open) stand in all three planes of irradiance(), so that whatever looks at a picture looks
    // at it likewise; validity is not asked for.
    Quantity quantity = Quantity::Irradiance;
    float roughness = 0.5f;  // of all pixels, where the quantity depends on it
};

// The renderer of `parameters.technique()`, for inputs of at most the size of `inputs`; everything is
// compiled before this returns.
std::unique_ptr<IndirectRenderer> makeRenderer(const Parameters& parameters, const RenderInputs& inputs,
                                               const DeviceOptions& options);
// The same on a device that is open already (null: only for techniques of the host).
std::unique_ptr<IndirectRenderer> makeRenderer(const Parameters& parameters, const RenderInputs& inputs,
                                               const lightwell::Device* device);

// Medians over measured frames, with each frame's own times beside them.
struct FrameFigures {
    std::vector<PassTime> passes;
    double totalMilliseconds = -1.0, wallMilliseconds = -1.0;
    std::vector<double> frameTotals, frameWalls;  // of each measured frame, in order
    // ... of technique auto: "technique parameters" that it ran, else "".
    std::vector<std::string> frameTechniques;
    std::uint64_t deviceBytes = 0, hostCopyBytes = 0, estimatedBytes = 0;
    std::vector<std::pair<std::string, std::uint64_t>> counts;  // of the last frame
    std::vector<std::pair<std::string, std::string>> choices;
};

// `warmUpCount` unmeasured frames of one view, in which caches and clocks settle, then `count` measured
// ones; the first of all is a reset.
FrameFigures measure(IndirectRenderer& renderer, const RenderInputs& inputs, int warmUpCount, int count);
// The same over a sequence: `inputsOf(frame)`, frame = 0 .. warmUpCount + count - 1, is called before
// each frame, outside of its time, and serves until the next call.
using FrameInputs = std::function<const RenderInputs&(int frame)>;
FrameFigures measure(IndirectRenderer& renderer, const FrameInputs& inputsOf, int warmUpCount,
                     int count);

}  // namespace cli
