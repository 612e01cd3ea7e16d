#include "library_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "cli.h"

namespace cli {
namespace {

// A name may come several times in a frame; its times are summed.
std::vector<PassTime> passTimes(const LWStats& stats) {
    std::vector<PassTime> passes;
    for (std::uint32_t i = 0; i < stats.passCount; ++i) {
        const LWPassTime& from = stats.passes[i];
        auto pass = std::find_if(passes.begin(), passes.end(),
                                 [&](const PassTime& known) { return known.name == from.name; });
        if (pass == passes.end()) pass = passes.insert(pass, {from.name, 0.0, 0});
        const bool isKnown = pass->milliseconds >= 0.0 && from.milliseconds >= 0.0;
        pass->milliseconds = isKnown ? pass->milliseconds + from.milliseconds : -1.0;
        pass->launches += from.launches;
    }
    return passes;
}

}  // namespace

FrameSample describeFrame(const LWStats& stats, double wallMilliseconds) {
    FrameSample frame;
    frame.passes = passTimes(stats);
    frame.totalMilliseconds = stats.totalMilliseconds;
    frame.wallMilliseconds = wallMilliseconds;
    frame.deviceBytes = stats.deviceBytes;
    frame.hostCopyBytes = stats.hostCopyBytes;
    for (std::uint32_t i = 0; i < stats.countCount; ++i)
        frame.counts.emplace_back(stats.counts[i].name, stats.counts[i].value);
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        frame.choices.emplace_back(stats.choices[i].name, stats.choices[i].reason);
    return frame;
}

LibraryRenderer::LibraryRenderer(const lightwell::Device& device, const Parameters& parameters,
                                 const RenderInputs& inputs, Quantity quantity, float roughness)
    : device_(device),
      view_(device, std::uint32_t(inputs.gbuffer().width), std::uint32_t(inputs.gbuffer().height)),
      descriptor_(device, parameters),
      tellsRsmVersions_(parameters.tellsRsmVersions()),
      technique_(device, parameters.technique().c_str(), descriptor_.get()),
      quantity_(quantity),
      vpls_(!parameters.takesVpls()         ? FrameVpls()
            : parameters.vplsFile().empty() ? FrameVpls(inputs, parameters.vplsCap())
                                            : FrameVpls(parameters.vplsFile(), inputs)),
      irradiance_(inputs.gbuffer().width, inputs.gbuffer().height, 3),
      validity_(inputs.gbuffer().width, inputs.gbuffer().height, 1),
      share_(inputs.gbuffer().width, inputs.gbuffer().height, 1),
      roughnessOfAll_(roughness),
      estimatedBytes_(device.estimateMemory(
          parameters.technique().c_str(), descriptor_.get(), std::uint32_t(inputs.gbuffer().width),
          std::uint32_t(inputs.gbuffer().height), inputs.rsmTexelCount())) {
    fillRoughness(inputs.gbuffer().width, inputs.gbuffer().height);
    for (std::size_t i = 0; i < inputs.lwSources().size(); ++i)
        sources_.emplace_back(device_, std::uint32_t(inputs.gbuffer().width),
                              std::uint32_t(inputs.gbuffer().height));
    technique_.prewarm(view_);
    info_ = device_.info();
}

LibraryRenderer::~LibraryRenderer() {
    lwFinish(device_.get());
}

// The view changes its size without allocating; the host's pictures are made anew.
void LibraryRenderer::fitSize(int width, int height) {
    if (width == irradiance_.width() && height == irradiance_.height()) return;
    view_.setSize(std::uint32_t(width), std::uint32_t(height));
    for (lightwell::View& source : sources_) source.setSize(std::uint32_t(width), std::uint32_t(height));
    irradiance_ = studio::PlanarBuffer(width, height, 3);
    validity_ = studio::PlanarBuffer(width, height, 1);
    share_ = studio::PlanarBuffer(width, height, 1);
    fillRoughness(width, height);
}

void LibraryRenderer::fillRoughness(int width, int height) {
    roughness_ = studio::PlanarBuffer(width, height, 1);
    for (int y = 0; y < height; ++y) std::fill_n(roughness_.row(0, y), width, roughnessOfAll_);
}

LWOutput LibraryRenderer::describeOutput() {
    LWOutput output = lightwell::make<LWOutput>();
    const QuantityEntry& entry = entryOf(quantity_);
    output.*entry.output = describePlanes(entry.isShare ? share_ : irradiance_);
    if (quantity_ == Quantity::Irradiance) output.validity = describePlanes(validity_);
    return output;
}

void LibraryRenderer::render(LWGBuffer gbuffer) {
    if (entryOf(quantity_).hasRoughness) gbuffer.roughness = describePlanes(roughness_);
    const LWOutput output = describeOutput();
    try {
        technique_.render(view_, gbuffer, output);
    } catch (const lightwell::Error& error) {
        if (quantity_ != Quantity::Irradiance && error.status() == LW_ERROR_UNSUPPORTED)
            throw UsageError(fmt::format("--quantity: {}", error.what()));
        throw;
    }
}

void LibraryRenderer::spreadShare() {
    for (int plane = 0; plane < 3; ++plane)
        for (int y = 0; y < share_.height(); ++y)
            std::copy_n(share_.row(0, y), share_.width(), irradiance_.row(plane, y));
}

FrameSample LibraryRenderer::renderFrame(const RenderInputs& inputs, bool reset) {
    fitSize(inputs.gbuffer().width, inputs.gbuffer().height);
    const auto start = std::chrono::steady_clock::now();
    std::vector<LWSourceView> sources{{view_.get(), &inputs.lwGBuffer()}};
    for (std::size_t i = 0; i < sources_.size(); ++i)
        sources.push_back({sources_[i].get(), &inputs.lwSources().at(i)});
    LWFrame frame = lightwell::make<LWFrame>();
    frame.reset = reset || frameIndex_ == 0 ? 1 : 0;
    frame.frameIndex = frameIndex_++;
    frame.lights = (tellsRsmVersions_ ? inputs.versionedLights() : inputs.lights()).data();
    frame.lightCount = std::uint32_t(inputs.lights().size());
    frame.sourceViews = sources.data();
    frame.sourceViewCount = std::uint32_t(sources.size());
    frame.geometry = &inputs.geometry();
    std::copy_n(inputs.environment(), 3, frame.environment);
    frame.focus = inputs.focus();
    vpls_.fill(inputs, frame);
    technique_.update(frame);
    render(inputs.lwGBuffer());
    device_.finish();
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    if (entryOf(quantity_).isShare) spreadShare();
    return describeFrame(technique_.stats(), wall.count());
}

bool LibraryRenderer::hasDebugView(const std::string& name) const {
    const auto views = technique_.debugViews(&view_);
    return std::any_of(views.begin(), views.end(), [&](const auto& info) { return name == info.name; });
}

DebugPlanes LibraryRenderer::readDebugView(const std::string& name) const {
    std::vector<std::string> names;
    for (const LWDebugView& info : technique_.debugViews(&view_)) {
        if (name == info.name)
            return {info.width, info.height, info.channels, technique_.readDebugView(info, &view_)};
        names.emplace_back(info.name);
    }
    throw UsageError("unknown debug view '" + name + "'; valid: " + joinNames(names));
}

}  // namespace cli
