#include "reference_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <tuple>

#include "file_lock.h"
#include "film.h"
#include "path_tracer.h"

namespace cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Part of every name: raise it when the path tracer's result changes for another reason than its inputs.
constexpr int kTracerVersion = 2;
constexpr int kAllBounces = 64;     // Russian roulette ends paths long before
constexpr int kFewestSamples = 16;  // per pixel, before the halves are asked
constexpr int kMostSamples = 1 << 20;
constexpr const char* kChannels[] = {"R", "G", "B"};

struct TimeIsUp {};

std::vector<std::string> layersOf(int bounces) {
    if (bounces == 1) return {"bounce1"};
    if (bounces == 2) return {"bounce1", "bounce2"};
    return {"all"};
}

std::string layerText(int bounces) {
    return fmt::format("{}", fmt::join(layersOf(bounces), "+"));
}

// How far paths go for all of the counts; 0: to their end.
int depthOf(const std::vector<int>& bounces) {
    const bool hasAll = std::find(bounces.begin(), bounces.end(), 0) != bounces.end();
    return hasAll ? 0 : *std::max_element(bounces.begin(), bounces.end());
}

std::vector<int> countsWithin(int depth) {
    if (depth == 0) return {1, 2, 0};
    return depth == 1 ? std::vector<int>{1} : std::vector<int>{1, 2};
}

// One run's truths in the cache: layers bounce1, bounce2, all as far as its paths go, and the noise of
// each count of bounces.
class RunFile {
public:
    RunFile(const studio::RayScene& scene, const studio::GBuffer& view, const TruthRequest& request,
            const std::string& stem, int depth)
        : scene_(scene),
          view_(view),
          request_(request),
          depth_(depth),
          directory_(directoryOf(request)),
          name_(fmt::format("{}-{}-v{}", stem, depth == 0 ? "all" : std::to_string(depth),
                            kTracerVersion)),
          path_(directory_ / (name_ + ".exr")),
          checkpoint_(directory_ / (name_ + ".film")) {}

    static fs::path directoryOf(const TruthRequest& request) {
        return request.directory.empty() ? fs::path(truthCacheDirectory()) : fs::path(request.directory);
    }
    bool isKept() const { return kept_.width != 0; }
    double noiseOf(int bounces) const { return noiseIn(kept_, bounces); }

    // What is kept, if anything is; a checkpoint without a picture counts where any noise will do.
    void load() {
        if (fs::exists(path_)) kept_ = readKept();
        if (!isKept() && request_.takesKept && fs::exists(checkpoint_))
            keep(compact(traceOn(0, 0.0)), {});
    }

    // Traces on until each count is good enough or time is up, and keeps the result if it is better.
    void improve(const std::vector<int>& counts) {
        const Clock::time_point start = Clock::now();
        studio::Image traced;
        try {
            for (const int bounces : counts)
                if (traced.width == 0 || noiseIn(traced, bounces) > request_.noise)
                    traced = compact(traceOn(bounces, request_.noise, start));
        } catch (const TimeIsUp&) {
            traced = compact(traceOn(0, 0.0));
        }
        // Time may be up before the new picture is as good as the one that is kept.
        if (!isKept() || samplesOf(traced) > samplesOf(kept_)) keep(std::move(traced), counts);
    }

    Truth truthOf(int bounces) const {
        Truth truth;
        truth.bounces = bounces;
        truth.name = name_;
        truth.samples = samplesOf(kept_);
        truth.noise = noiseOf(bounces);
        truth.image = studio::Image(kept_.width, kept_.height);
        for (const std::string channel : kChannels) {
            std::vector<float>& sum = truth.image.plane(channel);
            for (const std::string& layer : layersOf(bounces)) {
                const std::vector<float>& values = kept_.plane(layer + "." + channel);
                for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
            }
        }
        const std::string noise = "noise." + layerText(bounces);
        truth.image.metadata = {{"layer", layerText(bounces)},
                                {"spp", kept_.metadata.at("spp")},
                                {noise, kept_.metadata.at(noise)}};
        return truth;
    }

private:
    studio::Image readKept() const {
        try {
            studio::Image image = studio::readImage(path_.string());
            for (const int bounces : countsWithin(depth_)) {
                noiseIn(image, bounces);
                for (const std::string& layer : layersOf(bounces)) image.plane(layer + ".R");
            }
            samplesOf(image);
            return image;
        } catch (const std::exception& error) {
            throw std::runtime_error(
                fmt::format("{}: expected a kept truth: {}; delete it to have it traced anew",
                            path_.string(), error.what()));
        }
    }

    static double noiseIn(const studio::Image& image, int bounces) {
        return std::stod(image.metadata.at("noise." + layerText(bounces)));
    }
    static int samplesOf(const studio::Image& image) { return std::stoi(image.metadata.at("spp")); }

    // `counts`: once all of these are good enough nobody goes on from the checkpoint.
    void keep(studio::Image image, const std::vector<int>& counts) {
        kept_ = std::move(image);
        const fs::path unfinished = directory_ / (name_ + ".part.exr");
        studio::writeExr(unfinished.string(), kept_);
        fs::rename(unfinished, path_);
        const bool isDone = !counts.empty() &&
                            std::all_of(counts.begin(), counts.end(),
                                        [&](int bounces) { return noiseOf(bounces) <= request_.noise; });
        if (isDone) fs::remove(checkpoint_);
    }

    // Until this count's noise is reached; noise 0: what the checkpoint holds.
    studio::Image traceOn(int bounces, double noise, Clock::time_point start = {}) const {
        studio::PathTracerOptions options;
        options.maxBounces = depth_ == 0 ? kAllBounces : depth_;
        options.checkpoint = checkpoint_.string();
        options.sendersSeenBy = request_.sendersSeenBy;
        options.samplesPerPixel = noise > 0.0 ? kFewestSamples : 2;
        if (noise > 0.0) {
            options.judgedLayers = layersOf(bounces);
            options.maxSamplesPerPixel = kMostSamples;
            options.untilRelMse = noise;
            options.progress = [&, start](double fraction, double now) {
                const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
                if (request_.seconds > 0.0) fraction = std::max(fraction, seconds / request_.seconds);
                if (request_.progress) request_.progress(std::min(fraction, 1.0), now);
                if (request_.seconds > 0.0 && seconds > request_.seconds) throw TimeIsUp();
            };
        }
        try {
            return studio::tracePaths(scene_, view_, options);
        } catch (const studio::CheckpointError& error) {
            throw std::runtime_error(
                fmt::format("{}; delete it to have the truth traced anew", error.what()));
        }
    }

    // The layers without their halves; what these tell of the noise as metadata.
    studio::Image compact(const studio::Image& traced) const {
        studio::Image image(traced.width, traced.height);
        image.metadata["spp"] = traced.metadata.at("spp");
        for (const int bounces : countsWithin(depth_)) {
            for (const std::string& layer : layersOf(bounces))
                for (const std::string channel : kChannels)
                    image.plane(layer + "." + channel) = traced.plane(layer + "." + channel);
            image.metadata["noise." + layerText(bounces)] =
                fmt::format("{:.9g}", studio::estimateNoise(traced, layersOf(bounces)));
        }
        return image;
    }

    const studio::RayScene& scene_;
    const studio::GBuffer& view_;
    const TruthRequest& request_;
    int depth_;
    fs::path directory_;
    std::string name_;
    fs::path path_, checkpoint_;
    studio::Image kept_;  // of width 0: none
};

// The kept run with the least noise in this count; null: none has it.
const RunFile* leastNoisy(const std::map<int, RunFile>& runs, int bounces) {
    const RunFile* best = nullptr;
    for (const auto& [depth, run] : runs) {
        const std::vector<int> counts = countsWithin(depth);
        const bool has = std::find(counts.begin(), counts.end(), bounces) != counts.end();
        if (has && run.isKept() && (best == nullptr || run.noiseOf(bounces) < best->noiseOf(bounces)))
            best = &run;
    }
    return best;
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

std::vector<Truth> obtainTruths(const studio::RayScene& scene, const studio::GBuffer& view,
                                const TruthRequest& request) {
    const bool isKnown = std::all_of(request.bounces.begin(), request.bounces.end(),
                                     [](int bounces) { return bounces >= 0 && bounces <= 2; });
    if (request.bounces.empty() || !isKnown)
        throw std::invalid_argument(fmt::format("truths of {} bounces: expected 1, 2 or 0 (all)",
                                                fmt::join(request.bounces, ", ")));
    const bool isPart = !request.sendersSeenBy.empty();
    if (isPart && request.bounces != std::vector<int>{1})
        throw std::invalid_argument(
            fmt::format("truths of {} bounces by senders that pictures show: expected 1",
                        fmt::join(request.bounces, ", ")));
    fs::create_directories(RunFile::directoryOf(request));
    std::string stem = fmt::format("{}-{:016x}-{:016x}", scene.scene().name, studio::hashScene(scene),
                                   studio::hashView(view));
    if (isPart) stem += fmt::format("-seen-{:016x}", studio::hashPictureViews(request.sendersSeenBy));
    const FileLock lock(RunFile::directoryOf(request) / (stem + ".lock"), [&] {
        if (request.progress) request.progress(0.0, -1.0);
        return true;
    });
    std::map<int, RunFile> runs;  // by depth
    for (const int depth : isPart ? std::vector<int>{1} : std::vector<int>{1, 2, 0}) {
        const auto made = runs.emplace(std::piecewise_construct, std::forward_as_tuple(depth),
                                       std::forward_as_tuple(scene, view, request, stem, depth));
        made.first->second.load();
    }
    std::vector<int> missing;
    for (const int bounces : request.bounces) {
        const RunFile* best = leastNoisy(runs, bounces);
        const bool willDo =
            best != nullptr && (request.takesKept || best->noiseOf(bounces) <= request.noise);
        if (!willDo) missing.push_back(bounces);
    }
    if (!missing.empty()) runs.at(depthOf(missing)).improve(missing);
    std::vector<Truth> truths;
    for (const int bounces : request.bounces)
        truths.push_back(leastNoisy(runs, bounces)->truthOf(bounces));
    return truths;
}

}  // namespace cli
