// Authored virtual point lights and soft blockers (technique static_vpl) and the JSON file that they stand
// in: docs/vpls-file.md says what each key means.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene.h"

namespace studio {

// A place on a surface that stands for the surface around it.
struct StaticVpl {
    glm::vec3 position{0.0f}, normal{0.0f, 1.0f, 0.0f};  // of `object` where there is one; normal unit
    glm::vec3 reflectance{0.5f};
    // Times StaticVpls::areaPerWeight: the area that it stands for. None: by the distance to its neighbours.
    std::optional<float> weight;
    std::uint32_t lightMask = ~0u, receiverMask = ~0u;
    std::uint32_t population = 0;  // of hits that place-vpls merged into it; 0: set by hand
    std::string name, object;      // object: of the scene, with which it moves; "": at rest
};

// A sphere that dims the light passing it.
struct StaticBlocker {
    glm::vec3 center{0.0f};
    float radius = 0.0f;
    std::string name, object;
};

struct StaticVpls {
    float metresPerUnit = 1.0f;  // lengths below are in units
    float areaPerWeight = 1.0f;  // units^2
    std::vector<StaticVpl> vpls;
    std::vector<StaticBlocker> blockers;
};

constexpr std::size_t kMostStaticVpls = 4096, kMostStaticBlockers = 1024;

// Errors: std::runtime_error naming file, key, what was expected and what came. What is written reads back
// bit for bit.
StaticVpls readStaticVpls(const std::string& path);
void writeStaticVpls(const std::string& path, const StaticVpls& vpls);

// In metres, and in the world where the scene's objects are at this time; `object` is empty then, and every
// VPL has a weight: one without stands for a disc that reaches half-way to the nearest other VPL. Errors:
// std::runtime_error naming an object that the scene has not, or a VPL without weight that has no other.
StaticVpls posedVpls(const StaticVpls& vpls, const Scene& scene, float time);

}  // namespace studio
