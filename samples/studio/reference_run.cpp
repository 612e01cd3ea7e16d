#include "reference_run.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>

#include <fmt/format.h>

#include "lit_points.h"
#include "noise.h"
#include "parallel.h"

namespace studio {
namespace {

constexpr int kTileSize = 16;  // pixels along a side: coherent rays, and work enough for one hand-out

// Samples of all pixels in one pass: long enough that its end costs nothing, short enough that a cut-off
// run loses seconds.
constexpr std::size_t kSamplesPerPass = std::size_t(1) << 18;

std::vector<Tile> tilesOf(const Film& film) {
    std::vector<Tile> tiles;
    for (int y = 0; y < film.height; y += kTileSize)
        for (int x = 0; x < film.width; x += kTileSize)
            tiles.push_back(
                {x, y, std::min(x + kTileSize, film.width), std::min(y + kTileSize, film.height)});
    return tiles;
}

std::vector<std::size_t> judgedLayers(const Film& film, const PathTracerOptions& options) {
    std::vector<std::size_t> chosen;
    for (const std::string& name : options.judgedLayers) {
        const auto found = std::find(film.layers.begin(), film.layers.end(), name);
        requireOption(found != film.layers.end(), "judgedLayers",
                      fmt::format("names of {}", fmt::join(film.layers, ", ")), "\"" + name + "\"");
        chosen.push_back(std::size_t(found - film.layers.begin()));
    }
    if (chosen.empty()) chosen.push_back(film.layers.size() - 1);
    return chosen;
}

std::uint64_t hashOptions(const PathTracerOptions& options, const GBuffer& view, int halves) {
    const std::uint64_t values[] = {options.seed, std::uint64_t(options.maxBounces),
                                    std::uint64_t(options.unshadowed), std::uint64_t(halves)};
    std::uint64_t hash = hashBytes(values, sizeof values, 3);
    if (options.commonPoints) hash = hashBytes("common", 6, hash);
    if (options.guide != nullptr) {
        const std::uint64_t guide = options.guide->hash();
        hash = hashBytes(&guide, sizeof guide, hash);
    }
    if (!options.sendersSeenBy.empty()) {
        const std::uint64_t senders = hashPictureViews(options.sendersSeenBy);
        hash = hashBytes(&senders, sizeof senders, hash);
    }
    if (options.specular != nullptr) {
        hash = hashBytes("specular", 8, hash);
        hash = hashBytes(&options.specular->roughness, sizeof options.specular->roughness, hash);
        hash = hashBytes(&view.camera.position, sizeof view.camera.position, hash);
    }
    if (options.ambient != nullptr) {
        hash = hashBytes(options.ambient->isUniform ? "uniform" : "cosine", 6, hash);
        hash = hashBytes(&options.ambient->radius, sizeof options.ambient->radius, hash);
        // Its radius is one in the picture, whose angle the positions of a pixel or two don't tell.
        const std::uint64_t picture = hashPictureViews({{view.camera, view.width, view.height}});
        hash = hashBytes(&picture, sizeof picture, hash);
    }
    if (options.vpls != nullptr)
        hash = hashBytes(options.vpls->data(), options.vpls->size() * sizeof(VplRecord), hash);
    return hash;
}

}  // namespace

void requireOption(bool holds, const char* option, const std::string& expected,
                   const std::string& came) {
    if (!holds)
        throw std::invalid_argument(
            fmt::format("path tracer, {}: expected {}, got {}", option, expected, came));
}

PixelSurfaces::PixelSurfaces(const RayScene& scene, const GBuffer& view) {
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

std::vector<Surface> PixelSurfaces::shown() const {
    std::vector<Surface> result;
    for (std::size_t i = 0; i < surface.size(); ++i)
        if (valid[i]) result.push_back(surface[i]);
    return result;
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

Run::Run(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
         const PathTracerOptions& options, Film& film, std::uint32_t enough, std::uint32_t most)
    : pixels_(pixels),
      options_(options),
      film_(film),
      enough_(enough),
      most_(most),
      judged_(judgedLayers(film, options)) {
    if (options.checkpoint.empty()) return;
    key_ = {hashScene(scene), hashView(view), hashOptions(options, view, film.halves)};
    loadCheckpoint(options.checkpoint, key_, film);
}

void Run::fill(const TileBody& body) {
    const std::vector<Tile> tiles = tilesOf(film_);
    const auto perPass = std::uint32_t(
        std::max<std::size_t>(1, kSamplesPerPass / (film_.pixelCount() * std::size_t(film_.halves))));
    for (assess(); !finished(); assess())
        pass(body, tiles, std::min(film_.samples + perPass, film_.samples < enough_ ? enough_ : most_));
    save(true);
    report(film_.samples);
}

void Run::pass(const TileBody& body, const std::vector<Tile>& tiles, std::uint32_t last) {
    const std::uint32_t first = film_.samples;
    std::exception_ptr stop;  // the caller's wish to end: granted when the pass is whole
    parallelFor(
        tiles.size(), options_.threads, [&](std::size_t tile) { body(tiles[tile], first, last); },
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

void Run::assess() {
    if (options_.untilRelMse > 0.0 && film_.samples > 0) noise_ = filmNoise(film_, pixels_, judged_);
}

bool Run::finished() const {
    if (film_.samples < enough_) return false;
    return options_.untilRelMse <= 0.0 || noise_ <= options_.untilRelMse || film_.samples >= most_;
}

void Run::report(double samples) const {
    if (!options_.progress) return;
    double needed = enough_;
    if (options_.untilRelMse > 0.0)  // the squared error falls as one over the samples
        needed = noise_ < 0.0 ? most_
                              : std::clamp(film_.samples * noise_ / options_.untilRelMse,
                                           double(enough_), double(most_));
    options_.progress(std::min(1.0, samples / needed), noise_);
}

void Run::save(bool atOnce) {
    if (options_.checkpoint.empty()) return;
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> since = now - saved_;
    if (!atOnce && since.count() < options_.checkpointSeconds) return;
    saveCheckpoint(options_.checkpoint, key_, film_);
    saved_ = now;
}

}  // namespace studio
