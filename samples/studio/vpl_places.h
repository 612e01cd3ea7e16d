// Many hits on surfaces, merged into the few places that static VPLs stand at, and how much surface each of
// these stands for.
#pragma once

#include <cstdint>
#include <vector>

#include "free_space.h"

namespace studio {

// The mean of the hits merged into it.
struct VplPlace {
    glm::vec3 position{0.0f}, normal{0.0f}, reflectance{0.0f};
    int object = 0;
    std::uint32_t population = 0;  // of hits; 0: set by hand, takes hits up without moving
    double area = 0.0;             // m^2 that it stands for (weighPlaces)
};

struct MergeOptions {
    double spacing = 0.0;      // m: hits nearer than this to a place belong to it
    double leastCosine = 0.0;  // between the normals of a hit and of its place
    double reflectance = 0.0;  // most difference in any colour
};

// Adds hits to places, one after the other, each to the nearest place that is alike; where there is none it
// is a new place. Goes on from `places`. False, with the work left half done, as soon as there are more than
// `most` places.
bool mergeHits(const std::vector<SurfaceHit>& hits, const MergeOptions& options, std::size_t most,
               std::vector<VplPlace>& places);

// The `cap` places of the largest population, those set by hand first; in their order. Returns how many hits
// the others had.
std::uint64_t keepHeaviest(std::size_t cap, std::vector<VplPlace>& places);

// Shares the scene's surfaces out to the places, by samples evenly over their area and both of their sides: each to the
// nearest place within `reach` whose normal is at least `leastCosine` alike and that it sees, both raised
// by `lift` off their surfaces. Sets VplPlace::area.
struct WeighOptions {
    double reach = 0.0, lift = 0.0, leastCosine = 0.0;
    std::uint64_t seed = 1;
    int threads = 0;
    std::function<void(double)> progress;
};
void weighPlaces(const RayScene& scene, const WeighOptions& options, std::vector<VplPlace>& places);

}  // namespace studio
