// Direct light of glowing surfaces: which triangles emit, and the irradiance they give a point.
#pragma once

#include <cstdint>
#include <vector>

#include "ray_scene.h"

namespace studio {

// The emissive triangles of a scene at its time; empty unless Scene::emissiveSurfaces.
class EmitterSet {
public:
    explicit EmitterSet(const RayScene& scene);
    bool empty() const { return triangles_.empty(); }
    double power() const { return total_; }  // W, of the largest colour channel; both sides emit

    struct Sample {
        glm::vec3 position{0.0f}, normal{0.0f}, emission{0.0f};
        float areaDensity = 0.0f;  // 1/m^2
    };
    // A point on the emitters, area times radiance deciding how often; u in [0,1)^2.
    Sample sample(const glm::vec2& u) const;
    // Density per area with which sample() picks a point of this emission.
    float areaDensity(const glm::vec3& emission) const;

    // Irradiance from the emitters straight to a surface, shadow rays included: deterministic, from
    // kSamples points on emitters and kSamples cosine-distributed rays, joined by the power heuristic.
    glm::vec3 irradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                         const glm::vec3& normal, std::uint32_t pixel) const;
    static constexpr int kSamples = 64;

private:
    struct Triangle {
        glm::vec3 a, ab, ac, normal, emission;
        double upTo = 0.0;  // running sum of weights
    };
    const RayScene& scene_;
    std::vector<Triangle> triangles_;
    double total_ = 0.0;
};

}  // namespace studio
