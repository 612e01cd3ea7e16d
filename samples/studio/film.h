// Running sums of a path-traced image, and their checkpoints on disk.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gbuffer.h"

namespace studio {

// Sums over samples, in double so that neither their number nor the grouping of a resumed run shows.
struct Film {
    int width = 0, height = 0;
    std::vector<std::string> layers;
    int halves = 2;
    std::uint32_t samples = 0;     // done, in each half
    std::vector<glm::dvec3> sums;  // [pixel][half][layer]

    Film(int filmWidth, int filmHeight, std::vector<std::string> layerNames, int halfCount)
        : width(filmWidth),
          height(filmHeight),
          layers(std::move(layerNames)),
          halves(halfCount),
          sums(pixelCount() * layers.size() * std::size_t(halfCount), glm::dvec3(0.0)) {}
    std::size_t pixelCount() const { return std::size_t(width) * std::size_t(height); }
    glm::dvec3* at(std::size_t pixel, int half) {
        return &sums[(pixel * std::size_t(halves) + std::size_t(half)) * layers.size()];
    }
    const glm::dvec3* at(std::size_t pixel, int half) const {
        return &sums[(pixel * std::size_t(halves) + std::size_t(half)) * layers.size()];
    }
};

// What a checkpoint belongs to: hashes of everything that its sums depend on, apart from their number.
struct CheckpointKey {
    std::uint64_t scene = 0, view = 0, options = 0;
};
std::uint64_t hashScene(const RayScene& scene);
std::uint64_t hashView(const GBuffer& gbuffer);
std::uint64_t hashBytes(const void* data, std::size_t bytes, std::uint64_t seed);

// Replaces `path` in one step, so that a run cut off while saving leaves the checkpoint before.
void saveCheckpoint(const std::string& path, const CheckpointKey& key, const Film& film);
// False when there is no such file. Throws CheckpointError naming the path when the file is not a
// checkpoint, is cut short, or belongs to another scene, view or set of options.
bool loadCheckpoint(const std::string& path, const CheckpointKey& key, Film& film);

}  // namespace studio
