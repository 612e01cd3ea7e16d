#include "reference_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>

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
constexpr std::chrono::milliseconds kLockInterval{200};
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

// One process at a time works on a view's files; the lock ends with the process.
class FileLock {
public:
    FileLock(const fs::path& path, const TruthRequest& request)
        : file_(::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666)) {
        if (file_ < 0)
            throw std::runtime_error(fmt::format("{}: {}", path.string(), std::strerror(errno)));
        while (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
            if (errno != EWOULDBLOCK && errno != EINTR) {
                const std::string reason = std::strerror(errno);
                ::close(file_);
                throw std::runtime_error(fmt::format("{}: {}", path.string(), reason));
            }
            try {
                if (request.progress) request.progress(0.0, -1.0);
            } catch (...) {
                ::close(file_);
                throw;
            }
            std::this_thread::sleep_for(kLockInterval);
        }
    }
    ~FileLock() { ::close(file_); }
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    int file_;
};

// A view's truths in the cache: layers bounce1, bounce2, all, and the noise of each count.
class ViewTruths {
public:
    ViewTruths(const studio::RayScene& scene, const studio::GBuffer& view, const TruthRequest& request)
        : scene_(scene),
          view_(view),
          request_(request),
          depth_(depthOf(request.bounces)),
          directory_(request.directory.empty() ? truthCacheDirectory() : request.directory),
          name_(fmt::format("{}-{:016x}-{:016x}-{}-v{}", scene.scene().name, studio::hashScene(scene),
                            studio::hashView(view), depth_ == 0 ? "all" : std::to_string(depth_),
                            kTracerVersion)),
          path_(directory_ / (name_ + ".exr")),
          checkpoint_(directory_ / (name_ + ".film")) {
        fs::create_directories(directory_);
    }

    std::vector<Truth> obtain() {
        const FileLock lock(directory_ / (name_ + ".lock"), request_);
        if (fs::exists(path_)) kept_ = readKept();
        if (kept_.width == 0 || !(request_.takesKept || isGoodEnough(kept_))) improve();
        std::vector<Truth> truths;
        for (const int bounces : request_.bounces) truths.push_back(truthOf(bounces));
        return truths;
    }

private:
    studio::Image readKept() const {
        try {
            studio::Image image = studio::readImage(path_.string());
            noiseOf(image, depth_);
            image.plane(layersOf(depth_).back() + ".R");
            std::stoi(image.metadata.at("spp"));
            return image;
        } catch (const std::exception& error) {
            throw std::runtime_error(
                fmt::format("{}: expected a kept truth: {}; delete it to have it traced anew",
                            path_.string(), error.what()));
        }
    }

    static double noiseOf(const studio::Image& image, int bounces) {
        return std::stod(image.metadata.at("noise." + layerText(bounces)));
    }

    bool isGoodEnough(const studio::Image& image) const {
        return std::all_of(request_.bounces.begin(), request_.bounces.end(),
                           [&](int bounces) { return noiseOf(image, bounces) <= request_.noise; });
    }

    // Traces on until each count is good enough or time is up, and keeps the result if it is better.
    void improve() {
        studio::Image traced;
        const bool hasFilm = fs::exists(checkpoint_);
        if (request_.takesKept && hasFilm) {
            traced = compact(traceOn(0, 0.0));
        } else {
            const Clock::time_point start = Clock::now();
            try {
                for (const int bounces : request_.bounces)
                    if (traced.width == 0 || noiseOf(traced, bounces) > request_.noise)
                        traced = compact(traceOn(bounces, request_.noise, start));
            } catch (const TimeIsUp&) {
                traced = compact(traceOn(0, 0.0));
            }
        }
        // Time may be up before the new picture is as good as the one that is kept.
        if (kept_.width != 0 && samplesOf(kept_) >= samplesOf(traced)) return;
        kept_ = std::move(traced);
        const fs::path unfinished = directory_ / (name_ + ".part.exr");
        studio::writeExr(unfinished.string(), kept_);
        fs::rename(unfinished, path_);
        if (isGoodEnough(kept_)) fs::remove(checkpoint_);
    }

    // Until this count's noise is reached; 0: what the checkpoint holds.
    studio::Image traceOn(int bounces, double noise, Clock::time_point start = {}) const {
        studio::PathTracerOptions options;
        options.maxBounces = depth_ == 0 ? kAllBounces : depth_;
        options.checkpoint = checkpoint_.string();
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

    static int samplesOf(const studio::Image& image) { return std::stoi(image.metadata.at("spp")); }

    Truth truthOf(int bounces) const {
        Truth truth;
        truth.bounces = bounces;
        truth.name = name_;
        truth.samples = samplesOf(kept_);
        truth.noise = noiseOf(kept_, bounces);
        truth.image = studio::Image(kept_.width, kept_.height);
        for (const std::string channel : kChannels) {
            std::vector<float>& sum = truth.image.plane(channel);
            for (const std::string& layer : layersOf(bounces)) {
                const std::vector<float>& values = kept_.plane(layer + "." + channel);
                for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
            }
        }
        for (const std::string key : {"layer", "spp"})
            truth.image.metadata[key] = key == "layer" ? layerText(bounces) : kept_.metadata.at(key);
        truth.image.metadata["noise." + layerText(bounces)] =
            kept_.metadata.at("noise." + layerText(bounces));
        return truth;
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
    return ViewTruths(scene, view, request).obtain();
}

}  // namespace cli
