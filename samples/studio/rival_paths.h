// A batch of paths that go one segment at a time: directions, rays, shading, lights, each for all of
// them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lit_points.h"
#include "rival_scene.h"

namespace studio {

// Planar, so that the arithmetic between the rays is vector code.
struct PathBatch {
    static constexpr int kSize = 1024;
    int count = 0;
    alignas(64) float position[3][kSize];  // off the surface
    alignas(64) float face[3][kSize], normal[3][kSize];
    alignas(64) float direction[3][kSize], throughput[3][kSize];
    alignas(64) std::uint32_t index[kSize];  // of the sample point
    alignas(64) std::int32_t target[kSize];  // pixel of the tile
    alignas(64) float point[2][kSize];       // in [0,1)^2
    alignas(64) float rayDensity[kSize];     // 1/m^2, with which its ray found the vertex
    alignas(64) std::int32_t alive[kSize];   // -1: this segment's ray is worth tracing
    // What the ray met.
    alignas(64) float distance[kSize], hitFace[3][kSize], u[kSize], v[kSize];
    alignas(64) std::uint32_t mesh[kSize], primitive[kSize];
};

struct ShadowBatch {
    int count = 0;
    alignas(64) float origin[3][PathBatch::kSize], direction[3][PathBatch::kSize];
    alignas(64) float reach[PathBatch::kSize], irradiance[3][PathBatch::kSize];
    alignas(64) std::int32_t target[PathBatch::kSize];
    alignas(64) std::int32_t lit[PathBatch::kSize];
};

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
    void intersect();
    void shade(int bounce, float* const sums[3]);
    void punctualLights(float* const sums[3]);
    void emitters(float* const sums[3]);
    void litPoints(float* const sums[3]);
    void connect(float* const sums[3]);  // traces shadow_ and adds what arrives

    int bounces_;
    bool asPackets_;
    const RivalScene* scene_ = nullptr;
    const LitPoints* litPoints_ = nullptr;
    PathBatch* batch_ = nullptr;
    ShadowBatch shadow_;
};

}  // namespace studio
