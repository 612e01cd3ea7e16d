// One sample of the indirect irradiance at a surface: a path, or a ray that sees through everything.
#pragma once

#include <array>
#include <utility>

#include "area_lights.h"
#include "lit_points.h"
#include "seen_surfaces.h"

namespace studio {

enum Layer { kDirect, kBounce1, kBounce2, kAllBounces, kLayerCount };
using LayerSample = std::array<glm::vec3, kLayerCount>;

class Integrator {
public:
    // `senders`: surfaces that reflect light, which must live as long; null: all.
    Integrator(const RayScene& scene, LitPoints litPoints, int maxBounces,
               const SeenSurfaces* senders = nullptr)
        : scene_(scene),
          areaLights_(scene),
          litPoints_(std::move(litPoints)),
          maxBounces_(maxBounces),
          senders_(senders),
          hasExtendedLight_(!areaLights_.empty() || scene.scene().sky != glm::vec3(0.0f)) {}

    // Irradiance by a path from `pixel`; `punctual`: what scene.directIrradiance gives there.
    LayerSample tracePath(const Surface& pixel, const glm::vec3& punctual, Sampler& sampler) const;

    // First-bounce irradiance by all surfaces along one ray, whatever stands between.
    glm::vec3 traceUnshadowed(const Surface& pixel, Sampler& sampler) const;

private:
    // Punctual lights at the surface that a ray from `at` met, less the share of connect().
    glm::vec3 punctualOfRay(const Surface& at, const glm::vec3& direction, const Hit& hit) const;
    // Irradiance of `at` by one lit point, less the share of rays.
    glm::vec3 connect(const Surface& at, Sampler& sampler) const;
    glm::vec3 lightThrough(const Surface& pixel, const glm::vec3& direction, const Hit& hit,
                           Sampler& sampler) const;
    glm::vec3 connectUnshadowed(const Surface& at, Sampler& sampler) const;
    bool sends(const glm::vec3& position, const glm::vec3& side) const {
        return senders_ == nullptr || senders_->contains(position, side);
    }

    const RayScene& scene_;
    AreaLights areaLights_;
    LitPoints litPoints_;
    int maxBounces_;
    const SeenSurfaces* senders_;
    bool hasExtendedLight_;  // emissive surfaces or a sky
};

}  // namespace studio
