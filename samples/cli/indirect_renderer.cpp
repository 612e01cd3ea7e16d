#include "indirect_renderer.h"

#include <algorithm>

#include "cli.h"
#include "host_techniques.h"
#include "library_renderer.h"
#include "open_device.h"

namespace cli {
namespace {

double median(std::vector<double> values) {
    if (values.empty()) return -1.0;
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 != 0 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

// One pass over the measured frames; not every frame need have it.
struct PassSamples {
    std::string name;
    std::vector<double> milliseconds;
    std::uint32_t launches = 0;
};

void addPasses(std::vector<PassSamples>& passes, const FrameSample& frame) {
    for (const PassTime& pass : frame.passes) {
        auto known = std::find_if(passes.begin(), passes.end(),
                                  [&](const PassSamples& each) { return each.name == pass.name; });
        if (known == passes.end()) known = passes.insert(known, {pass.name, {}, 0});
        known->milliseconds.push_back(pass.milliseconds);
        known->launches = pass.launches;
    }
}

}  // namespace

std::unique_ptr<IndirectRenderer> makeRenderer(const Parameters& parameters, const RenderInputs& inputs,
                                               const DeviceOptions& options) {
    if (!parameters.needsDevice()) {
        if (options.quantity != Quantity::Irradiance)
            throw UsageError("--quantity " + std::string(entryOf(options.quantity).name) + ": technique " +
                             parameters.technique() + " makes irradiance alone; expected one of the library");
        if (!inputs.lwSources().empty())
            throw UsageError("--source-view: technique " + parameters.technique() +
                             " looks at none; expected one of the library");
        return makeRenderer(parameters, inputs, nullptr);
    }
    const lightwell::Device device = openDevice(options.device, options.width);
    return std::make_unique<LibraryRenderer>(device, parameters, inputs, options.quantity,
                                             options.roughness);
}

std::unique_ptr<IndirectRenderer> makeRenderer(const Parameters& parameters, const RenderInputs& inputs,
                                               const lightwell::Device* device) {
    if (const HostTechnique* own = findHostTechnique(parameters.technique())) return own->make(parameters, inputs);
    if (device == nullptr)
        throw std::runtime_error("technique " + parameters.technique() +
                                 ": expected a device, got none");
    return std::make_unique<LibraryRenderer>(*device, parameters, inputs);
}

namespace {

std::string techniqueOf(const FrameSample& frame) {
    std::string technique, parameters;
    for (const auto& [name, what] : frame.choices) {
        if (name == "auto.technique") technique = what;
        if (name == "auto.parameters") parameters = what;
    }
    return technique + (parameters.empty() ? "" : " ") + parameters;
}

}  // namespace

FrameFigures measure(IndirectRenderer& renderer, const RenderInputs& inputs, int warmUpCount,
                     int count) {
    return measure(
        renderer, [&](int) -> const RenderInputs& { return inputs; }, warmUpCount, count);
}

FrameFigures measure(IndirectRenderer& renderer, const FrameInputs& inputsOf, int warmUpCount,
                     int count) {
    for (int i = 0; i < warmUpCount; ++i) renderer.renderFrame(inputsOf(i), i == 0);
    FrameFigures figures;
    figures.estimatedBytes = renderer.estimatedBytes();
    std::vector<PassSamples> passes;
    for (int i = 0; i < count; ++i) {
        FrameSample frame = renderer.renderFrame(inputsOf(warmUpCount + i), warmUpCount == 0 && i == 0);
        figures.frameTotals.push_back(frame.totalMilliseconds);
        figures.frameWalls.push_back(frame.wallMilliseconds);
        figures.frameTechniques.push_back(techniqueOf(frame));
        addPasses(passes, frame);
        figures.deviceBytes = frame.deviceBytes;
        figures.hostCopyBytes = frame.hostCopyBytes;
        figures.counts = std::move(frame.counts);
        figures.choices = std::move(frame.choices);
    }
    for (const PassSamples& pass : passes)
        figures.passes.push_back({pass.name, median(pass.milliseconds), pass.launches});
    figures.totalMilliseconds = median(figures.frameTotals);
    figures.wallMilliseconds = median(figures.frameWalls);
    return figures;
}

}  // namespace cli
