// A closed room, hits and options by hand, for tests of placed VPLs.
#pragma once

#include <cstddef>

#include "quad_scene.h"
#include "vpl_placement.h"
#include "vpl_places.h"

namespace test {

using glm::vec3;
using studio::MergeOptions;
using studio::PlacementOptions;
using studio::StaticVpls;
using studio::SurfaceHit;

constexpr double kCos45 = 0.70710678;

// A closed box from 0 to (2, 1, 1), each wall of another reflectance.
inline QuadScene room() {
    QuadScene s;
    const auto wall = [&](float r, const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
        s.quad(s.material(vec3(r)), a, b, c, d);
    };
    wall(0.1f, {0, 0, 0}, {2, 0, 0}, {2, 0, 1}, {0, 0, 1});
    wall(0.2f, {0, 1, 0}, {2, 1, 0}, {2, 1, 1}, {0, 1, 1});
    wall(0.3f, {0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0});
    wall(0.4f, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1});
    wall(0.5f, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1});
    wall(0.6f, {2, 0, 0}, {2, 1, 0}, {2, 1, 1}, {2, 0, 1});
    return s;
}

inline SurfaceHit hit(const vec3& position, const vec3& normal = {0, 1, 0}, float reflectance = 0.5f,
                      int object = 0) {
    return {position, glm::normalize(normal), vec3(reflectance), object};
}

inline MergeOptions merging(double spacing) {
    MergeOptions options;
    options.spacing = spacing;
    options.leastCosine = kCos45;
    options.reflectance = 0.1;
    return options;
}

inline bool same(const StaticVpls& a, const StaticVpls& b) {
    if (a.vpls.size() != b.vpls.size()) return false;
    for (std::size_t i = 0; i < a.vpls.size(); ++i)
        if (a.vpls[i].position != b.vpls[i].position || a.vpls[i].normal != b.vpls[i].normal ||
            a.vpls[i].weight != b.vpls[i].weight || a.vpls[i].population != b.vpls[i].population ||
            a.vpls[i].reflectance != b.vpls[i].reflectance)
            return false;
    return true;
}

inline PlacementOptions fewPaths() {
    PlacementOptions options;
    options.from = {{0.5f, 0.5f, 0.5f}};
    options.paths = 2000;
    options.cap = 60;
    return options;
}

}  // namespace test
