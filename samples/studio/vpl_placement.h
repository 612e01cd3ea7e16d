// Automatic placement of static VPLs (`lightwell place-vpls`): free space is explored, surfaces are found by paths,
// hits are merged into places, places are weighed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ray_scene.h"
#include "static_vpls.h"

namespace studio {

struct PlacementOptions {
    std::vector<glm::vec3> from;  // where the walks through free space begin
    int points = 30;              // of each walk
    int paths = 4096;             // from all points together
    int lightPaths = 4096;        // from all lights together
    int depth = 3;                // surfaces along a path
    int cap = 256;                // VPLs at most
    double spacing = 0.0;         // m; 0: the least, in steps of a fifth, at which `cap` holds
    double degrees = 45.0;        // most between the normals of what is merged
    double reflectance = 0.2;     // most difference between the reflectances of what is merged
    double offset = 0.0;          // m that VPLs are set back behind their surface
    std::uint64_t seed = 1;
    int threads = 0;  // 0: one per hardware thread; the result is the same
    std::function<void(double fraction, const std::string& doing)> progress;  // what it throws comes out
};

struct PlacementReport {
    std::size_t points = 0, hits = 0, places = 0;  // places: before the cap
    std::size_t earlier = 0, byHand = 0;           // of `vpls`, that were there before
    std::size_t withoutArea = 0;                   // places that no surface was found for, left out
    std::uint64_t lostHits = 0;                    // of places beyond the cap
    double spacing = 0.0, area = 0.0;              // m, m^2 of all VPLs with a weight
};

struct Placement {
    StaticVpls vpls;
    PlacementReport report;
};

// `earlier`: VPLs of runs before, which hits are merged into, with blockers and units; those set by hand
// (population 0) stay as they are. Same arguments, same bits. Errors: std::invalid_argument naming an option,
// std::runtime_error for a place of `from` that no surface surrounds, or an object that the scene has not.
Placement placeVpls(const RayScene& scene, const PlacementOptions& options, const StaticVpls& earlier);

}  // namespace studio
