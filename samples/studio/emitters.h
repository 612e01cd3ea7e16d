// Direct light that is not punctual: of glowing surfaces and of the sky.
#pragma once

#include <cstdint>
#include <vector>

#include "ray_scene.h"

namespace studio {

// The emissive triangles of a scene at its time (none unless Scene::emissiveSurfaces) and its sky.
class EmitterSet {
public:
    explicit EmitterSet(const RayScene& scene);
    bool empty() const { return triangles_.empty() && sky_ == glm::vec3(0.0f); }
    // Area times radiance, summed over the triangles, of the largest colour channel.
    double weight() const { return total_; }

    struct Sample {
        glm::vec3 position{0.0f}, normal{0.0f}, emission{0.0f};
        float areaDensity = 0.0f;  // 1/m^2
    };
    // A point on the emitters, area times radiance deciding how often; u in [0,1)^2.
    Sample sample(const glm::vec2& u) const;
    // Density per area with which sample() picks a point of this emission.
    float areaDensity(const glm::vec3& emission) const;

    // Irradiance from emitters and sky straight to a surface, shadow rays included: deterministic, from
    // kSamples points on emitters and kSamples cosine-distributed rays, joined by the power heuristic
    // (the sky by the rays alone).
    glm::vec3 irradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                         const glm::vec3& normal, std::uint32_t pixel) const;
    static constexpr int kSamples = 64;

private:
    struct Triangle {
        glm::vec3 a, ab, ac, normal, emission;
        double upTo = 0.0;  // running sum of weights
    };
    glm::vec3 fromPoints(const glm::vec3& origin, const glm::vec3& geometricNormal,
                         const glm::vec3& normal, std::uint32_t pixel) const;
    glm::vec3 fromRays(const glm::vec3& origin, const glm::vec3& geometricNormal,
                       const glm::vec3& normal, std::uint32_t pixel) const;

    const RayScene& scene_;
    glm::vec3 sky_;
    std::vector<Triangle> triangles_;
    double total_ = 0.0;
};

}  // namespace studio
