// What the rival's steps hand each other: paths and shadow rays, planar, so that the arithmetic between
// the rays is vector code.
#pragma once

#include <cstdint>

namespace studio {

constexpr std::uint32_t kNoMesh = ~0u;  // Embree's number for no geometry

// Paths of one thread; each segment fills what follows its given part.
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
    alignas(64) std::uint32_t mesh[PathBatch::kSize], primitive[PathBatch::kSize];  // of a glowing end
    alignas(64) std::int32_t lit[PathBatch::kSize];
};

}  // namespace studio
