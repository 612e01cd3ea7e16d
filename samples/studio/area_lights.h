// Emissive triangles as light sources: next-event estimation, proportional to power.
#pragma once

#include <vector>

#include "ray_scene.h"
#include "sampler.h"

namespace studio {

// A place that receives light: geometricNormal and normal unit, on the lit side.
struct Surface {
    glm::vec3 position{0.0f}, geometricNormal{0.0f}, normal{0.0f};
};

class AreaLights {
public:
    explicit AreaLights(const RayScene& scene);
    bool empty() const { return triangles_.empty(); }

    struct Point {
        int mesh = -1, triangle = -1;
        glm::vec2 weights{0.0f};  // barycentric, of the second and third vertex
        glm::vec3 position{0.0f};
        glm::vec3 normal{0.0f};  // of the triangle, unit, on either side
    };
    // A point on the emitters, area times mean radiance deciding how often; not for empty().
    Point pick(const glm::dvec2& fine) const;
    // Density per area with which pick() finds a point of this radiance, 1/m^2.
    float areaDensity(const glm::vec3& emission) const;

    // Estimate of the irradiance at `at` from all emissive triangles, less the share that
    // cosine-sampled rays bring (balance heuristic): add emissionOfRay for such a ray.
    glm::vec3 sampleIrradiance(const RayScene& scene, const Surface& at, Sampler& sampler) const;

    // The other share: what a ray of density cos / pi that found `hit` brings in emission.
    glm::vec3 emissionOfRay(const Surface& at, const glm::vec3& direction, const Hit& hit) const;

private:
    struct Triangle {
        int mesh, triangle;
        glm::vec3 corner, edge1, edge2;
        double upTo;  // power of this and all triangles before it, of the whole
    };
    // Irradiance integrand over the sum of both strategies' densities per solid angle.
    glm::vec3 weighted(const Surface& at, const glm::vec3& direction, const Hit& hit) const;

    std::vector<Triangle> triangles_;
    float perRadiance_ = 0.0f;  // density per area of a triangle of mean radiance 1
};

// A ray's share of light that it and another way both find, by the balance heuristic: `byRay`, `byOther`
// are the densities of finding it. (A direction in the horizon, which rounding may give, has no density
// and no share; an infinite density has all.)
inline float rayShare(float byRay, float byOther) {
    return byRay > 0.0f ? 1.0f / (1.0f + byOther / byRay) : 0.0f;
}

// One estimate of the irradiance from emissive surfaces and sky straight to `at`: a point on an emitter
// and a cosine-distributed ray, shadows included.
glm::vec3 extendedIrradiance(const RayScene& scene, const AreaLights& lights, const Surface& at,
                             Sampler& sampler);

}  // namespace studio
