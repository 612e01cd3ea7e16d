// Direct light that is not punctual, of glowing surfaces and of the sky, without noise that changes.
#pragma once

#include <cstdint>

#include "area_lights.h"

namespace studio {

// The emissive triangles of a scene at its time (none unless Scene::emissiveSurfaces) and its sky.
class EmitterSet {
public:
    explicit EmitterSet(const RayScene& scene) : scene_(scene), lights_(scene) {}
    bool empty() const { return lights_.empty() && scene_.scene().sky == glm::vec3(0.0f); }

    // Irradiance from emitters and sky straight to a surface, shadow rays included: the mean of kSamples
    // estimates of extendedIrradiance, the same ones whenever it is asked for this pixel.
    glm::vec3 irradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                         const glm::vec3& normal, std::uint32_t pixel) const;
    static constexpr int kSamples = 64;

private:
    const RayScene& scene_;
    AreaLights lights_;
};

}  // namespace studio
