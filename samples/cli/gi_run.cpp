// See gi_run.h.
#include "gi_run.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "cli.h"
#include "layers.h"
#include "library_renderer.h"
#include "open_device.h"

namespace cli {
namespace {

constexpr float kPi = 3.14159265358979323846f;

// Calls the library; what it refuses is the arguments' fault, and most often that an EXR has no geometry.
template <class F>
void asFrame(const Parameters& parameters, F&& call) {
    try {
        call();
    } catch (const lightwell::Error& error) {
        if (error.status() != LW_ERROR_INVALID_ARGUMENT && error.status() != LW_ERROR_UNSUPPORTED) throw;
        throw UsageError(fmt::format("technique {}: {}; an EXR brings no geometry, but the view and the RSMs as source views and lights",
                                     parameters.technique(), error.what()));
    }
}

LWFrame describeFrameOf(const HostFrame& host, const LWSourceView& source, int index) {
    LWFrame frame = lightwell::make<LWFrame>();
    frame.reset = index == 0 ? 1 : 0;
    frame.frameIndex = std::uint64_t(index);
    frame.lights = host.lights().data();
    frame.lightCount = std::uint32_t(host.lights().size());
    frame.sourceViews = &source;
    frame.sourceViewCount = 1;
    frame.focus = host.eye();
    return frame;
}

void keepFigures(const FrameSample& sample, RenderReport& report) {
    FrameFigures& figures = report.figures;
    figures.passes = sample.passes;
    figures.totalMilliseconds = sample.totalMilliseconds;
    figures.wallMilliseconds = sample.wallMilliseconds;
    figures.frameTotals = {sample.totalMilliseconds};
    figures.frameWalls = {sample.wallMilliseconds};
    figures.frameTechniques = {""};
    figures.deviceBytes = sample.deviceBytes;
    figures.hostCopyBytes = sample.hostCopyBytes;
    figures.counts = sample.counts;
    figures.choices = sample.choices;
}

void refuseVersions(const Parameters& parameters) {
    if (parameters.tellsRsmVersions())
        throw UsageError("--set rsm_versions: expected where maps stay from frame to frame, in render, chart, stability and probes; this is one frame");
}

}  // namespace

void requireFrameTechnique(const Parameters& parameters) {
    if (!parameters.needsDevice())
        throw UsageError(fmt::format("technique {}: expected one that lights a frame, this one traces rays in a scene; `lightwell render` has one",
                                     parameters.technique()));
    if (parameters.takesVpls())
        throw UsageError(fmt::format("technique {}: expected one that needs no static VPLs, which stand for places of a scene; `lightwell render` "
                                     "has one",
                                     parameters.technique()));
    refuseVersions(parameters);
}

GiLight renderGi(const HostFrame& host, const Parameters& parameters, const DeviceOptions& options, int frames, RenderReport& report,
                 std::vector<LWInputFinding>* findings) {
    lightwell::Device device = openDevice(options.device, options.width);
    const int width = host.view().width, height = host.view().height;
    GiLight light{studio::PlanarBuffer(width, height, 3), studio::PlanarBuffer(width, height, 1)};
    const lightwell::View view(device, std::uint32_t(width), std::uint32_t(height));
    const LWSourceView source{view.get(), &host.gbuffer()};
    const Descriptor descriptor(device, parameters);
    lightwell::Technique technique(device, parameters.technique().c_str(), descriptor.get());
    LWOutput output = lightwell::make<LWOutput>();
    output.irradiance = describePlanes(light.irradiance);
    output.validity = describePlanes(light.validity);
    asFrame(parameters, [&] {
        report.figures.estimatedBytes = device.estimateMemory(parameters.technique().c_str(), descriptor.get(), std::uint32_t(width),
                                                              std::uint32_t(height), describeFrameOf(host, source, 0));
        if (findings != nullptr) {
            const LWFrame frame = describeFrameOf(host, source, 0);
            *findings = lightwell::checkInputs(view, &frame, &host.gbuffer());
        }
        for (int i = 0; i < frames; ++i) {
            const auto start = std::chrono::steady_clock::now();
            technique.update(describeFrameOf(host, source, i));
            technique.render(view, host.gbuffer(), output);
            device.finish();
            const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
            if (i == frames - 1) keepFigures(describeFrame(technique.stats(), wall.count()), report);
        }
    });
    report.parameters = parameters.resolved();
    report.hasDevice = true;
    report.device = device.info();
    report.frames = frames;
    return light;
}

namespace {

// One file's irradiance, zero where the view shows no surface.
studio::PlanarBuffer readIrradiance(const std::string& path, const ChannelMap& channels, const HostSurfaces& view) {
    const studio::ExrLayers file(path);
    if (file.width() != view.width || file.height() != view.height)
        throw UsageError(fmt::format("--truth {}: expected the G-buffer's {}x{} pixels, got {}x{}", path, view.width, view.height, file.width(),
                                     file.height()));
    const bool wantsIrradiance = channels.preferred(Role::IndirectUncoloured, Role::Irradiance) == Role::Irradiance;
    const auto uncoloured = wantsIrradiance ? std::nullopt : channels.find(file, Role::IndirectUncoloured);
    const auto planes = file.planes(uncoloured ? *uncoloured : channels.need(file, Role::Irradiance));
    const float factor = uncoloured ? kPi : 1.0f;
    studio::PlanarBuffer irradiance(view.width, view.height, 3);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            if (view.normal.rgb(x, y) == glm::vec3(0.0f)) continue;
            const std::size_t i = std::size_t(y) * std::size_t(view.width) + std::size_t(x);
            const glm::vec3 value = factor * glm::vec3(planes[0][i], planes[1][i], planes[2][i]);
            if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z))
                throw UsageError(fmt::format("--truth {}: expected numbers on every surface, pixel ({}, {}) has none", path, x, y));
            irradiance.setRgb(x, y, value);
        }
    return irradiance;
}

}  // namespace

studio::PlanarBuffer readTruth(const std::vector<std::string>& paths, const ChannelMap& channels, const HostSurfaces& view, studio::Image& image) {
    studio::PlanarBuffer mean(view.width, view.height, 3);
    const float share = 1.0f / float(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const studio::PlanarBuffer one = readIrradiance(paths[i], channels, view);
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) mean.setRgb(x, y, mean.rgb(x, y) + share * one.rgb(x, y));
        if (paths.size() == 2) addLayer(image, i == 0 ? "a.irradiance." : "b.irradiance.", one);
    }
    return mean;
}

}  // namespace cli
