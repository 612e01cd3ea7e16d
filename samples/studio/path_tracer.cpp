// The reference run: fills a film pass by pass, saves it, and makes the image of it.
//
// What one sample is stands in integrator.cpp, light from given VPLs in vpl_visibility.cpp. This file is
// the frame: surfaces of the pixels, passes over tiles, when to stop, checkpoints, layers.
#include "path_tracer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "film.h"
#include "integrator.h"
#include "noise.h"
#include "parallel.h"
#include "vpl_visibility.h"

namespace studio {
namespace {

constexpr int kTileSize = 16;  // pixels along a side: coherent rays, and work enough for one hand-out

// Samples of all pixels in one pass: long enough that its end costs nothing, short enough that a cut-off
// run loses seconds.
constexpr std::size_t kSamplesPerPass = std::size_t(1) << 18;

constexpr const char* kLayerNames[kLayerCount] = {"direct", "bounce1", "bounce2", "all"};
constexpr char kChannels[3] = {'R', 'G', 'B'};

void check(bool holds, const char* option, const std::string& expected, const std::string& came) {
    if (!holds)
        throw std::invalid_argument(
            fmt::format("path tracer, {}: expected {}, got {}", option, expected, came));
}

void checkOptions(const GBuffer& view, const PathTracerOptions& o) {
    const auto text = [](auto value) { return fmt::format("{}", value); };
    check(view.width > 0 && view.height > 0, "view", "at least one pixel",
          fmt::format("{} x {}", view.width, view.height));
    check(view.position.width() == view.width && view.position.height() == view.height &&
              view.normal.width() == view.width && view.normal.height() == view.height,
          "view", "position and normal of the view's size", "other sizes");
    check(o.samplesPerPixel >= 2 && o.samplesPerPixel % 2 == 0, "samplesPerPixel",
          "an even number of at least 2", text(o.samplesPerPixel));
    check(o.untilRelMse >= 0.0 && std::isfinite(o.untilRelMse), "untilRelMse", "0 or a positive number",
          text(o.untilRelMse));
    check(o.untilRelMse == 0.0 || o.maxSamplesPerPixel >= o.samplesPerPixel, "maxSamplesPerPixel",
          "at least samplesPerPixel", text(o.maxSamplesPerPixel));
    check(o.maxBounces >= 1, "maxBounces", "at least 1", text(o.maxBounces));
    check(o.threads >= 0, "threads", "0 (all) or more", text(o.threads));
    check(o.vpls == nullptr || o.untilRelMse == 0.0, "untilRelMse", "0 with VPLs, which have no noise",
          text(o.untilRelMse));
}

// The pixels' surfaces. The G-buffer knows no geometric normal: the camera's ray is traced again, close
// about the pixel's position. Where it meets no surface there, the shading normal stands for it.
struct PixelSurfaces {
    std::vector<Surface> surface;
    std::vector<bool> valid;

    std::vector<Surface> shown() const {
        std::vector<Surface> result;
        for (std::size_t i = 0; i < surface.size(); ++i)
            if (valid[i]) result.push_back(surface[i]);
        return result;
    }

    PixelSurfaces(const RayScene& scene, const GBuffer& view) {
        constexpr float kAbout = 1e-4f;  // of the distance; a position's rounding is a hundredth of it
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                const glm::vec3 position = view.position.rgb(x, y), normal = view.normal.rgb(x, y);
                valid.push_back(glm::dot(normal, normal) > 0.0f);
                surface.push_back({position, normal, normal});
                if (!valid.back()) continue;
                const glm::vec3 ray = position - view.camera.position;
                const float distance = glm::length(ray);
                Hit hit;
                if (distance > 0.0f &&
                    scene.trace(view.camera.position, ray / distance, distance * (1.0f - kAbout),
                                distance * (1.0f + kAbout), hit))
                    surface.back().geometricNormal = hit.geometricNormal;
            }
    }
};

struct Tile {
    int x0, y0, x1, y1;
};

std::vector<Tile> tilesOf(const Film& film) {
    std::vector<Tile> tiles;
    for (int y = 0; y < film.height; y += kTileSize)
        for (int x = 0; x < film.width; x += kTileSize)
            tiles.push_back(
                {x, y, std::min(x + kTileSize, film.width), std::min(y + kTileSize, film.height)});
    return tiles;
}

// Calls body(pixel index) for each pixel with a surface.
template <class Body>
void forEachPixel(const Tile& tile, const Film& film, const PixelSurfaces& pixels, const Body& body) {
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const std::size_t pixel = std::size_t(y) * std::size_t(film.width) + std::size_t(x);
            if (pixels.valid[pixel]) body(pixel);
        }
}

double filmNoise(const Film& film, const PixelSurfaces& pixels, const std::vector<std::size_t>& layers) {
    if (film.halves != 2 || film.samples == 0) return 0.0;
    const auto sumOf = [&](std::size_t pixel, int half) {
        glm::dvec3 sum(0.0);
        for (const std::size_t layer : layers) sum += film.at(pixel, half)[layer];
        return sum / double(film.samples);
    };
    return halvesRelMse(film.pixelCount(), [&](std::size_t pixel, glm::dvec3& a, glm::dvec3& b) {
        if (!pixels.valid[pixel]) return false;
        a = sumOf(pixel, 0);
        b = sumOf(pixel, 1);
        return true;
    });
}

std::vector<std::size_t> judgedLayers(const Film& film, const PathTracerOptions& options) {
    std::vector<std::size_t> chosen;
    for (const std::string& name : options.judgedLayers) {
        const auto found = std::find(film.layers.begin(), film.layers.end(), name);
        check(found != film.layers.end(), "judgedLayers",
              fmt::format("names of {}", fmt::join(film.layers, ", ")), "\"" + name + "\"");
        chosen.push_back(std::size_t(found - film.layers.begin()));
    }
    if (chosen.empty()) chosen.push_back(film.layers.size() - 1);
    return chosen;
}

// Fills a film pass after pass until it has enough samples or is good enough.
class Run {
public:
    Run(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
        const PathTracerOptions& options, Film& film, std::uint32_t enough, std::uint32_t most)
        : pixels_(pixels),
          options_(options),
          film_(film),
          enough_(enough),
          most_(most),
          judged_(judgedLayers(film, options)) {
        if (options.checkpoint.empty()) return;
        key_ = {hashScene(scene), hashView(view), hashOptions()};
        loadCheckpoint(options.checkpoint, key_, film);
    }

    // body(tile, first sample, one past the last) adds samples of the tile's pixels to the film.
    template <class Body>
    void fill(const Body& body) {
        const std::vector<Tile> tiles = tilesOf(film_);
        const auto perPass = std::uint32_t(
            std::max<std::size_t>(1, kSamplesPerPass / (film_.pixelCount() * film_.halves)));
        for (assess(); !finished(); assess()) {
            const std::uint32_t first = film_.samples;
            const std::uint32_t last = std::min(first + perPass, first < enough_ ? enough_ : most_);
            std::exception_ptr stop;  // the caller's wish to end: granted when the pass is whole
            parallelFor(
                tiles.size(), options_.threads,
                [&](std::size_t tile) { body(tiles[tile], first, last); },
                [&](std::size_t tile) {
                    if (stop) return;
                    try {
                        report(first + (last - first) * double(tile) / double(tiles.size()));
                    } catch (...) {
                        stop = std::current_exception();
                    }
                });
            film_.samples = last;
            save(stop != nullptr);
            if (stop) std::rethrow_exception(stop);
        }
        save(true);
        report(film_.samples);
    }

private:
    using Clock = std::chrono::steady_clock;

    void assess() {
        if (options_.untilRelMse > 0.0 && film_.samples > 0) noise_ = filmNoise(film_, pixels_, judged_);
    }

    bool finished() const {
        if (film_.samples < enough_) return false;
        return options_.untilRelMse <= 0.0 || noise_ <= options_.untilRelMse || film_.samples >= most_;
    }

    void report(double samples) const {
        if (!options_.progress) return;
        double needed = enough_;
        if (options_.untilRelMse > 0.0)  // the squared error falls as one over the samples
            needed = noise_ < 0.0 ? most_
                                  : std::clamp(film_.samples * noise_ / options_.untilRelMse,
                                               double(enough_), double(most_));
        options_.progress(std::min(1.0, samples / needed), noise_);
    }

    void save(bool atOnce) {
        if (options_.checkpoint.empty()) return;
        const Clock::time_point now = Clock::now();
        const std::chrono::duration<double> since = now - saved_;
        if (!atOnce && since.count() < options_.checkpointSeconds) return;
        saveCheckpoint(options_.checkpoint, key_, film_);
        saved_ = now;
    }

    std::uint64_t hashOptions() const {
        const std::uint64_t values[] = {options_.seed, std::uint64_t(options_.maxBounces),
                                        std::uint64_t(options_.unshadowed), std::uint64_t(film_.halves)};
        std::uint64_t hash = hashBytes(values, sizeof values, 3);
        if (options_.vpls != nullptr)
            hash = hashBytes(options_.vpls->data(), options_.vpls->size() * sizeof(VplRecord), hash);
        return hash;
    }

    const PixelSurfaces& pixels_;
    const PathTracerOptions& options_;
    Film& film_;
    std::uint32_t enough_, most_;  // samples of each half
    std::vector<std::size_t> judged_;
    CheckpointKey key_;
    Clock::time_point saved_ = Clock::now();
    double noise_ = -1.0;
};

Film integratePaths(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                    const PathTracerOptions& options) {
    std::vector<std::string> layers(kLayerNames, kLayerNames + kLayerCount);
    if (options.unshadowed) layers = {kLayerNames[kBounce1]};
    Film film(view.width, view.height, layers, 2);
    const int most = options.untilRelMse > 0.0 ? options.maxSamplesPerPixel : options.samplesPerPixel;
    Run run(scene, view, pixels, options, film, std::uint32_t(options.samplesPerPixel / 2),
            std::uint32_t(most / 2));
    const Integrator integrator(scene, pixels.shown(), options.maxBounces, options.unshadowed);

    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
            const Surface& at = pixels.surface[pixel];
            const glm::vec3 punctual =
                options.unshadowed ? glm::vec3(0.0f)
                                   : scene.directIrradiance(at.position, at.geometricNormal, at.normal);
            for (int half = 0; half < 2; ++half)
                for (std::uint32_t s = first; s < last; ++s) {
                    Sampler sampler(options.seed, 2 * pixel + std::size_t(half), s);
                    glm::dvec3* sums = film.at(pixel, half);
                    if (options.unshadowed) {
                        sums[0] += glm::dvec3(integrator.traceUnshadowed(at, sampler));
                        continue;
                    }
                    const LayerSample sample = integrator.tracePath(at, punctual, sampler);
                    for (int layer = 0; layer < kLayerCount; ++layer)
                        sums[layer] += glm::dvec3(sample[std::size_t(layer)]);
                }
        });
    });
    return film;
}

// A VPL is a sample of this film; VPLs outside, pixels inside, so that a tile's shadow rays converge.
Film gatherVpls(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                const PathTracerOptions& options) {
    const std::vector<VplRecord>& vpls = *options.vpls;
    Film film(view.width, view.height, {kLayerNames[kBounce1]}, 1);
    Run run(scene, view, pixels, options, film, std::uint32_t(vpls.size()), std::uint32_t(vpls.size()));

    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t v = first; v < last; ++v)
            forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
                const Surface& at = pixels.surface[pixel];
                const glm::dvec3 irradiance = vplIrradiance(vpls[v], at);
                if (irradiance == glm::dvec3(0.0)) return;
                if (options.unshadowed || vplVisible(scene, vpls[v], at))
                    *film.at(pixel, 0) += irradiance;
            });
    });
    return film;
}

// The layer's planes: of the half, or of both together (`half` < 0).
void addLayer(Image& image, const Film& film, std::size_t layer, int half, double scale) {
    const std::string prefix = half < 0 ? "" : half == 0 ? "a." : "b.";
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float>& plane = image.plane(prefix + film.layers[layer] + "." + kChannels[channel]);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            double sum = 0.0;
            for (int h = 0; h < film.halves; ++h)
                if (half < 0 || h == half) sum += film.at(i, h)[layer][channel];
            plane[i] = float(sum * scale);
        }
    }
}

}  // namespace

Image tracePaths(const RayScene& scene, const GBuffer& view, const PathTracerOptions& options) {
    checkOptions(view, options);
    const PixelSurfaces pixels(scene, view);
    const Film film = options.vpls != nullptr ? gatherVpls(scene, view, pixels, options)
                                              : integratePaths(scene, view, pixels, options);

    Image image(view.width, view.height);
    std::vector<float>& validity = image.plane("validity");
    for (std::size_t i = 0; i < validity.size(); ++i) validity[i] = pixels.valid[i] ? 1.0f : 0.0f;
    const double perSample = options.vpls != nullptr ? 1.0 : 1.0 / film.samples;
    for (std::size_t layer = 0; layer < film.layers.size(); ++layer) {
        addLayer(image, film, layer, -1, perSample / film.halves);
        for (int half = 0; film.halves == 2 && half < 2; ++half)
            addLayer(image, film, layer, half, perSample);
        image.metadata["noise." + film.layers[layer]] =
            fmt::format("{:.6g}", filmNoise(film, pixels, {layer}));
    }
    if (options.vpls != nullptr) {
        image.metadata["vpls"] = fmt::format("{}", options.vpls->size());
    } else {
        image.metadata["spp"] = fmt::format("{}", 2 * film.samples);
        image.metadata["seed"] = fmt::format("{}", options.seed);
    }
    return image;
}

double estimateNoise(const Image& image, const std::vector<std::string>& layers) {
    const std::vector<float>& validity = image.plane("validity");
    std::vector<const std::vector<float>*> planes[2];  // of a half: R, G, B of each layer
    for (int half = 0; half < 2; ++half)
        for (const std::string& layer : layers)
            for (const char channel : kChannels)
                planes[half].push_back(&image.plane((half == 0 ? "a." : "b.") + layer + "." + channel));
    const auto sumOf = [&](std::size_t pixel, int half) {
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < planes[half].size(); ++i)
            sum[int(i % 3)] += double((*planes[half][i])[pixel]);
        return sum;
    };
    return halvesRelMse(image.pixelCount(), [&](std::size_t pixel, glm::dvec3& a, glm::dvec3& b) {
        if (validity[pixel] <= 0.0f) return false;
        a = sumOf(pixel, 0);
        b = sumOf(pixel, 1);
        return true;
    });
}

}  // namespace studio
