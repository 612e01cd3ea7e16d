// A batch of paths that go one segment at a time: directions, rays, shading, lights, each for all of
// them.
#pragma once

#include <cstdint>

#include "lit_points.h"
#include "rival_batch.h"
#include "rival_scene.h"

namespace studio {

// Traces batches on one thread.
class RivalPaths {
public:
    RivalPaths(int bounces, bool asPackets) : bounces_(bounces), asPackets_(asPackets) {}

    // Adds each path's irradiance of bounces 1 to `bounces` to sums[channel][target]. The batch's
    // positions, normals, indices and targets are given; the rest is the batch's own.
    // `litPoints`: the other end of connections, or null for none.
    void trace(const RivalScene& scene, const LitPoints* litPoints, std::uint64_t seed, PathBatch& batch,
               float* const sums[3]);
    std::uint64_t rays = 0, shadowRays = 0;

private:
    void draw(std::uint64_t seed, int pair);  // batch.point
    void shade(int bounce, float* const sums[3]);
    void punctualLights(float* const sums[3]);
    void emitters(float* const sums[3]);
    void litPoints(float* const sums[3]);
    // A straight way from a vertex: `cosine` at its shading normal, 0 where the way starts under its
    // face.
    struct Link {
        glm::vec3 direction{0.0f};
        float distance = 0.0f, squared = 0.0f, cosine = 0.0f;
    };
    Link linkTo(int vertex, const glm::vec3& position) const;
    // Adds a shadow ray to shadow_; `irradiance`: what it brings to the pixel if nothing is in its way.
    void queue(int vertex, const glm::vec3& direction, float reach, const glm::vec3& irradiance);
    void addLit(float* const sums[3]);  // empties shadow_

    int bounces_;
    bool asPackets_;
    const RivalScene* scene_ = nullptr;
    const LitPoints* litPoints_ = nullptr;
    PathBatch* batch_ = nullptr;
    ShadowBatch shadow_;
};

}  // namespace studio
