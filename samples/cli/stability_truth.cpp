#include "stability_truth.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "film.h"
#include "noise.h"
#include "path_tracer.h"
#include "reference_cache.h"

namespace cli {
namespace {

namespace fs = std::filesystem;

// Part of every name: raise it when the result changes for another reason than its inputs.
constexpr int kVersion = 2;
constexpr int kAllBounces = 64;          // Russian roulette ends paths long before
constexpr std::size_t kRecentMost = 40;  // a little over a sequence of frames

std::string fileName(const studio::RayScene& scene, const studio::GBuffer& view,
                     const SequenceTruths::Request& request) {
    return fmt::format("{}-{:016x}-{:016x}-{:016x}-b{}-n{}{}-s{}", scene.scene().name,
                       studio::hashScene(scene), studio::hashView(view), request.guide->hash(),
                       request.bounces == 0 ? "all" : std::to_string(request.bounces), request.samples,
                       request.sharesPoints ? "" : "-own", kVersion);
}

std::vector<float> planesOf(const studio::Image& image, const std::string& prefix) {
    std::vector<float> planes;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>& plane = image.plane(prefix + channel);
        planes.insert(planes.end(), plane.begin(), plane.end());
    }
    return planes;
}

studio::Image trace(const studio::RayScene& scene, const studio::GBuffer& view,
                    const SequenceTruths::Request& request) {
    studio::PathTracerOptions options;
    options.samplesPerPixel = request.samples;
    options.maxBounces = request.bounces == 0 ? kAllBounces : request.bounces;
    options.commonPoints = request.sharesPoints;
    options.guide = request.guide;
    if (request.progress)
        options.progress = [&](double fraction, double) { request.progress(fraction); };
    return studio::tracePaths(scene, view, options);
}

// Layers "a." and "b.": the two references of so many bounces, and "validity".
studio::Image referencesOf(const studio::Image& traced, int bounces) {
    std::vector<std::string> layers = {bounces == 0 ? "all" : "bounce1"};
    if (bounces == 2) layers.push_back("bounce2");
    studio::Image image(traced.width, traced.height);
    for (const std::string half : {"a.", "b."})
        for (const char* channel : {"R", "G", "B"}) {
            std::vector<float>& sum = image.plane(half + channel);
            for (const std::string& layer : layers) {
                const std::vector<float>& values = traced.plane(half + layer + "." + channel);
                for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
            }
        }
    image.plane("validity") = traced.plane("validity");
    return image;
}

FrameTruth fromImage(const studio::Image& image, const std::string& name, int samples) {
    FrameTruth truth;
    truth.name = name;
    truth.samples = samples;
    truth.first = planesOf(image, "a.");
    truth.second = planesOf(image, "b.");
    for (std::size_t i = 0; i < truth.first.size(); ++i)
        truth.mean.push_back(0.5f * (truth.first[i] + truth.second[i]));
    const std::vector<float>& validity = image.plane("validity");
    const std::size_t count = image.pixelCount();
    truth.noise = studio::halvesRelMse(count, [&](std::size_t pixel, glm::dvec3& a, glm::dvec3& b) {
        for (std::size_t c = 0; c < 3; ++c) {
            a[int(c)] = double(truth.first[c * count + pixel]);
            b[int(c)] = double(truth.second[c * count + pixel]);
        }
        return validity[pixel] > 0.0f;
    });
    return truth;
}

// Replaces in one step, so that a run cut off while saving, or a second run beside this one, leaves a
// whole file.
void save(const std::string& path, const studio::Image& image) {
    const std::string unfinished = fmt::format("{}.{}.part.exr", path, getpid());
    studio::writeExr(unfinished, image);
    fs::rename(unfinished, path);
}

FrameTruth readKept(const std::string& path, const std::string& name, int samples) {
    try {
        return fromImage(studio::readImage(path), name, samples);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format(
            "{}: expected a kept truth: {}; delete it to have it traced anew", path, error.what()));
    }
}

}  // namespace

SequenceTruths::SequenceTruths(const std::string& directory)
    : directory_(directory.empty() ? truthCacheDirectory() : directory) {
    fs::create_directories(directory_);
}

std::shared_ptr<const FrameTruth> SequenceTruths::obtain(const studio::RayScene& scene,
                                                         const studio::GBuffer& view,
                                                         const Request& request) {
    const std::string name = fileName(scene, view, request);
    const auto known = recent_.find(name);
    if (known != recent_.end()) return known->second;
    const std::string path = (fs::path(directory_) / (name + ".exr")).string();
    FrameTruth truth;
    if (fs::exists(path)) {
        truth = readKept(path, name, request.samples);
    } else {
        const studio::Image traced = trace(scene, view, request);
        const studio::Image image = referencesOf(traced, request.bounces);
        save(path, image);
        ++traced_;
        if (request.keepsFirstBounce) {
            Request first = request;
            first.bounces = 1;
            const fs::path also = fs::path(directory_) / (fileName(scene, view, first) + ".exr");
            if (!fs::exists(also)) save(also.string(), referencesOf(traced, 1));
        }
        truth = fromImage(image, name, request.samples);
    }
    if (recent_.size() >= kRecentMost) recent_.clear();
    return recent_[name] = std::make_shared<FrameTruth>(std::move(truth));
}

std::shared_ptr<const FrameTruth> darkTruth(int width, int height) {
    const auto truth = std::make_shared<FrameTruth>();
    truth->mean.assign(3 * std::size_t(width) * std::size_t(height), 0.0f);
    truth->first = truth->second = truth->mean;
    truth->name = "dark";
    return truth;
}

}  // namespace cli
