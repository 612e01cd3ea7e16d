// A scene's triangles as a host hands them to Lightwell: world positions, one reflectance and one
// emission each.
#pragma once

#include <cstdint>
#include <vector>

#include "ray_scene.h"

namespace studio {

struct SceneTriangles {
    std::vector<float> vertices;  // xyz of three corners each
    std::vector<float> albedo;    // rgb each: the mean over the triangle of the reflectance
    std::vector<float> emission;  // rgb radiance each; empty: nothing glows
    std::uint64_t version = 0;    // of the contents: equal versions, equal triangles
    std::uint32_t count() const { return std::uint32_t(vertices.size() / 9); }
};

// At the ray scene's time. Triangles that an alpha mask cuts away by more than half are left out: as whole ones they
// would block what passes through their holes.
SceneTriangles sceneTriangles(const RayScene& scene);

}  // namespace studio
