// A lamp of another program and the cameras of its reflective shadow maps, as a light file has them (docs/hosts/light.schema.json).
#pragma once

#include <string>
#include <vector>

#include "host_camera.h"
#include "scene.h"

namespace cli {

struct HostLight {
    studio::Light light;
    std::vector<float> profile;       // factors on the intensity by the angle to `direction`, at even steps from 0 to pi; or none
    std::vector<HostCamera> cameras;  // of its maps, one at least
    bool fluxFromDirect = false;      // a texel's flux from the direct light that the map itself shows, not from the lamp's figures

    // W/sr along `toSurface` (unit), or W/m^2 on a plane that faces a sun.
    glm::dvec3 emittedAlong(const glm::dvec3& toSurface) const;
};

// Throws std::runtime_error naming file, key, expectation and what came. Cameras that do not look as the lamp shines are refused: a spot's or a
// point's must stand in it and be perspective ones, a sun's orthographic ones along its rays.
HostLight readLightFile(const std::string& path);

}  // namespace cli
