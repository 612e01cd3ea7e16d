#include "render_frames.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "cli.h"

namespace cli {
namespace {

double median(std::vector<double> values) {
    if (values.empty()) return -1.0;
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 != 0 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

// One pass over the measured frames. A name may come several times in a frame; its times are summed.
struct PassSamples {
    std::string name;
    std::vector<double> milliseconds;
    std::uint32_t launches = 0;
};

void addFrame(std::vector<PassSamples>& passes, const LWStats& stats) {
    std::map<std::string, std::pair<double, std::uint32_t>> frame;
    for (std::uint32_t i = 0; i < stats.passCount; ++i) {
        const LWPassTime& pass = stats.passes[i];
        const bool isKnown = std::any_of(passes.begin(), passes.end(), [&](const PassSamples& known) {
            return known.name == pass.name;
        });
        if (!isKnown) passes.push_back({pass.name, {}, 0});
        auto& sum = frame[pass.name];
        sum.first = sum.first < 0.0 || pass.milliseconds < 0.0 ? -1.0 : sum.first + pass.milliseconds;
        sum.second += pass.launches;
    }
    for (PassSamples& pass : passes) {
        const auto found = frame.find(pass.name);
        if (found == frame.end()) continue;  // a pass that not every frame has
        pass.milliseconds.push_back(found->second.first);
        pass.launches = found->second.second;
    }
}

void copyLast(FrameFigures& figures, const LWStats& stats) {
    figures.deviceBytes = stats.deviceBytes;
    figures.hostCopyBytes = stats.hostCopyBytes;
    for (std::uint32_t i = 0; i < stats.countCount; ++i)
        figures.counts.emplace_back(stats.counts[i].name, stats.counts[i].value);
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        figures.choices.emplace_back(stats.choices[i].name, stats.choices[i].reason);
}

}  // namespace

FrameRunner::FrameRunner(const lightwell::Device& device, const std::string& technique,
                         const Parameters& parameters, const RenderInputs& inputs)
    : device_(device),
      inputs_(inputs),
      view_(device, std::uint32_t(inputs.gbuffer().width), std::uint32_t(inputs.gbuffer().height)),
      technique_(device, technique.c_str(), parameters.descriptor()),
      irradiance_(inputs.gbuffer().width, inputs.gbuffer().height, 3),
      validity_(inputs.gbuffer().width, inputs.gbuffer().height, 1),
      estimatedBytes_(device.estimateMemory(
          technique.c_str(), parameters.descriptor(), std::uint32_t(inputs.gbuffer().width),
          std::uint32_t(inputs.gbuffer().height), inputs.rsmTexelCount())) {
    technique_.prewarm(view_);
}

void FrameRunner::renderFrame() {
    LWSourceView source{view_.get(), &inputs_.lwGBuffer()};
    LWFrame frame = lightwell::make<LWFrame>();
    frame.reset = frameIndex_ == 0 ? 1 : 0;
    frame.frameIndex = frameIndex_++;
    frame.lights = inputs_.lights().data();
    frame.lightCount = std::uint32_t(inputs_.lights().size());
    frame.sourceViews = &source;
    frame.sourceViewCount = 1;
    std::copy_n(inputs_.environment(), 3, frame.environment);
    LWOutput output = lightwell::make<LWOutput>();
    output.irradiance = describePlanes(irradiance_);
    output.validity = describePlanes(validity_);
    technique_.update(frame);
    technique_.render(view_, inputs_.lwGBuffer(), output);
    device_.finish();
}

FrameFigures FrameRunner::run(int warmUpCount, int count) {
    for (int i = 0; i < warmUpCount; ++i) renderFrame();
    FrameFigures figures;
    figures.estimatedBytes = estimatedBytes_;
    std::vector<PassSamples> passes;
    std::vector<double> totals, walls;
    for (int i = 0; i < count; ++i) {
        const auto start = std::chrono::steady_clock::now();
        renderFrame();
        walls.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        const LWStats stats = technique_.stats();
        totals.push_back(stats.totalMilliseconds);
        addFrame(passes, stats);
        if (i + 1 == count) copyLast(figures, stats);
    }
    for (const PassSamples& pass : passes)
        figures.passes.push_back({pass.name, median(pass.milliseconds), pass.launches});
    figures.totalMilliseconds = median(totals);
    figures.wallMilliseconds = median(walls);
    return figures;
}

DebugPlanes FrameRunner::readDebugView(const std::string& name) const {
    std::vector<std::string> names;
    for (const LWDebugView& info : technique_.debugViews(&view_)) {
        if (name == info.name)
            return {info.width, info.height, info.channels, technique_.readDebugView(info, &view_)};
        names.emplace_back(info.name);
    }
    throw UsageError("unknown debug view '" + name + "'; valid: " + joinNames(names));
}

}  // namespace cli
