// One sample of the indirect irradiance at a surface: a path, or a ray that sees through everything.
#pragma once

#include <array>

#include "area_lights.h"

namespace studio {

enum Layer { kDirect, kBounce1, kBounce2, kAllBounces, kLayerCount };
using LayerSample = std::array<glm::vec3, kLayerCount>;

class Integrator {
public:
    Integrator(const RayScene& scene, int maxBounces)
        : scene_(scene), areaLights_(scene), maxBounces_(maxBounces) {}

    // Irradiance by a path from `pixel`; `punctual`: what scene.directIrradiance gives there.
    LayerSample tracePath(const Surface& pixel, const glm::vec3& punctual, Sampler& sampler) const;

    // First-bounce irradiance by all surfaces along one ray, whatever stands between.
    glm::vec3 traceUnshadowed(const Surface& pixel, Sampler& sampler) const;

private:
    glm::vec3 punctualIrradiance(const Surface& at) const {
        return scene_.directIrradiance(at.position, at.geometricNormal, at.normal);
    }
    // All light sources at once: punctual, emissive surfaces, sky.
    glm::vec3 directIrradiance(const Surface& at, Sampler& sampler) const;

    const RayScene& scene_;
    AreaLights areaLights_;
    int maxBounces_;
};

}  // namespace studio
