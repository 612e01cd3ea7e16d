// The frame of a reference run: the pixels' surfaces, passes over tiles, when to stop, checkpoints.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "area_lights.h"
#include "film.h"
#include "path_tracer.h"

namespace studio {

// Throws std::invalid_argument naming the option unless `holds`.
void requireOption(bool holds, const char* option, const std::string& expected, const std::string& came);

// The pixels' surfaces. The G-buffer knows no geometric normal: the camera's ray is traced again, close
// about the pixel's position. Where it meets no surface there, the shading normal stands for it.
struct PixelSurfaces {
    std::vector<Surface> surface;
    std::vector<bool> valid;

    PixelSurfaces(const RayScene& scene, const GBuffer& view);
    std::vector<Surface> shown() const;  // the valid ones
};

struct Tile {
    int x0, y0, x1, y1;
};

// Calls body(pixel index) for each pixel with a surface.
template <class Body>
void forEachPixel(const Tile& tile, const Film& film, const PixelSurfaces& pixels, const Body& body) {
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const std::size_t pixel = std::size_t(y) * std::size_t(film.width) + std::size_t(x);
            if (pixels.valid[pixel]) body(pixel);
        }
}

// Estimated relMSE of the sum of some of the film's layers; 0 without halves.
double filmNoise(const Film& film, const PixelSurfaces& pixels, const std::vector<std::size_t>& layers);

// Fills a film pass after pass until it has enough samples or is good enough.
class Run {
public:
    // Adds samples [first, last) of the tile's pixels to the film.
    using TileBody = std::function<void(const Tile&, std::uint32_t first, std::uint32_t last)>;

    // `enough`, `most`: samples of each half. Goes on from the options' checkpoint where there is one.
    Run(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
        const PathTracerOptions& options, Film& film, std::uint32_t enough, std::uint32_t most);
    void fill(const TileBody& body);

private:
    using Clock = std::chrono::steady_clock;

    void pass(const TileBody& body, const std::vector<Tile>& tiles, std::uint32_t last);
    void assess();
    bool finished() const;
    void report(double samples) const;
    void save(bool atOnce);

    const PixelSurfaces& pixels_;
    const PathTracerOptions& options_;
    Film& film_;
    std::uint32_t enough_, most_;
    std::vector<std::size_t> judged_;
    CheckpointKey key_;
    Clock::time_point saved_ = Clock::now();
    double noise_ = -1.0;
};

}  // namespace studio
