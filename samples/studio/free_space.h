// Where a scene is empty, and which surfaces can be seen from there and from its lights: what static VPLs are
// placed by.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "ray_scene.h"

namespace studio {

// A walk through free space: from `from` half of the way to the surface that a ray in a random direction
// meets, and so on, until there are `count` points, `from` the first. Rays that leave the scene are drawn anew; a
// place that sees no surface is an error (std::runtime_error naming it).
std::vector<glm::vec3> exploreFreeSpace(const RayScene& scene, const glm::vec3& from, int count,
                                        std::uint64_t seed);

// A place on a surface that a path met.
struct SurfaceHit {
    glm::vec3 position{0.0f}, normal{0.0f}, reflectance{0.0f};  // normal: shading, on the path's side
    int object = 0;                                             // index in Scene::objects
};

struct PathOptions {
    int paths = 4096, lightPaths = 4096;  // from all points together, from all lights together
    int depth = 3;                        // surfaces that a path meets at most
    std::uint64_t seed = 1;
    int threads = 0;
    std::function<void(double)> progress;  // in [0, 1], by the calling thread; what it throws comes out
};

// Paths from all points in all directions, and from all lights along their rays (light_rays.h), from each
// surface on in directions by the cosine. In the order of the paths, whatever the threads.
std::vector<SurfaceHit> findSurfaces(const RayScene& scene, const std::vector<glm::vec3>& points,
                                     const PathOptions& options);

}  // namespace studio
