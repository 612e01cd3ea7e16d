#include "reference_cache.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "film.h"
#include "path_tracer.h"

namespace cli {
namespace {

namespace fs = std::filesystem;

// Part of every name: raise it when the path tracer's result changes for another reason than its inputs.
constexpr int kTracerVersion = 1;
constexpr int kAllBounces = 64;     // Russian roulette ends paths long before
constexpr int kFewestSamples = 16;  // per pixel, before the halves are asked
constexpr int kMostSamples = 1 << 20;

struct TimeIsUp {};

std::vector<std::string> layersOf(int bounces) {
    if (bounces == 1) return {"bounce1"};
    if (bounces == 2) return {"bounce1", "bounce2"};
    return {"all"};
}

studio::PathTracerOptions tracerOptions(const TruthRequest& request) {
    studio::PathTracerOptions options;
    options.maxBounces = request.bounces == 0 ? kAllBounces : request.bounces;
    options.judgedLayers = layersOf(request.bounces);
    return options;
}

std::string fileName(const studio::RayScene& scene, const studio::GBuffer& view, int bounces) {
    return fmt::format("{}-{:016x}-{:016x}-b{}-v{}", scene.scene().name, studio::hashScene(scene),
                       studio::hashView(view), bounces == 0 ? "all" : std::to_string(bounces),
                       kTracerVersion);
}

studio::Image traceUntil(const studio::RayScene& scene, const studio::GBuffer& view,
                         const TruthRequest& request, const std::string& path) {
    using Clock = std::chrono::steady_clock;
    studio::PathTracerOptions options = tracerOptions(request);
    options.checkpoint = path;
    options.samplesPerPixel = kFewestSamples;
    options.maxSamplesPerPixel = kMostSamples;
    options.untilRelMse = request.noise;
    const Clock::time_point start = Clock::now();
    options.progress = [&](double fraction, double noise) {
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (request.seconds > 0.0) fraction = std::max(fraction, seconds / request.seconds);
        if (request.progress) request.progress(std::min(fraction, 1.0), noise);
        if (request.seconds > 0.0 && seconds > request.seconds) throw TimeIsUp();
    };
    try {
        return studio::tracePaths(scene, view, options);
    } catch (const TimeIsUp&) {
        options.untilRelMse = 0.0;  // what the checkpoint holds
        options.samplesPerPixel = 2;
        options.progress = nullptr;
        return studio::tracePaths(scene, view, options);
    }
}

// R, G, B: the sum of the layers; the noise as metadata.
studio::Image assemble(const studio::Image& traced, const std::vector<std::string>& layers) {
    studio::Image image(traced.width, traced.height);
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& sum = image.plane(channel);
        for (const std::string& layer : layers) {
            const std::vector<float>& values = traced.plane(layer + "." + channel);
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
        }
    }
    const std::string layer = fmt::format("{}", fmt::join(layers, "+"));
    image.metadata["layer"] = layer;
    image.metadata["noise." + layer] = fmt::format("{:.9g}", studio::estimateNoise(traced, layers));
    image.metadata["spp"] = traced.metadata.at("spp");
    return image;
}

void readFigures(Truth& truth) {
    truth.noise = std::stod(truth.image.metadata.at("noise." + truth.image.metadata.at("layer")));
    truth.samples = std::stoi(truth.image.metadata.at("spp"));
}

}  // namespace

std::string truthCacheDirectory() {
    for (const auto& [variable, below] : {std::pair{"LIGHTWELL_CACHE_DIR", "references"},
                                          std::pair{"XDG_CACHE_HOME", "lightwell/references"},
                                          std::pair{"HOME", ".cache/lightwell/references"}})
        if (const char* value = std::getenv(variable); value != nullptr && *value != '\0')
            return (fs::path(value) / below).string();
    throw std::runtime_error(
        "no place for references: expected LIGHTWELL_CACHE_DIR, XDG_CACHE_HOME or HOME, "
        "none is set");
}

Truth obtainTruth(const studio::RayScene& scene, const studio::GBuffer& view,
                  const TruthRequest& request) {
    const fs::path directory =
        request.directory.empty() ? fs::path(truthCacheDirectory()) : fs::path(request.directory);
    fs::create_directories(directory);
    Truth truth;
    truth.bounces = request.bounces;
    truth.name = fileName(scene, view, request.bounces);
    const std::string path = (directory / (truth.name + ".exr")).string();
    const std::string checkpoint = (directory / (truth.name + ".film")).string();
    Truth kept = truth;
    if (fs::exists(path)) {
        kept.image = studio::readImage(path);
        readFigures(kept);
        if (kept.noise <= request.noise) return kept;
    }
    truth.image = assemble(traceUntil(scene, view, request, checkpoint), layersOf(request.bounces));
    readFigures(truth);
    // Time may be up before the new picture is as good as the one that is kept.
    if (kept.samples > 0 && kept.noise < truth.noise) return kept;
    if (truth.noise <= request.noise) {
        const std::string unfinished = (directory / (truth.name + ".part.exr")).string();
        studio::writeExr(unfinished, truth.image);
        fs::rename(unfinished, path);
        fs::remove(checkpoint);
    }
    return truth;
}

}  // namespace cli
