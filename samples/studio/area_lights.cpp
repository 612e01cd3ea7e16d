// Next-event estimation of emissive triangles with multiple importance sampling.
//
// Source: E. Veach and L. Guibas, "Optimally Combining Sampling Techniques" (SIGGRAPH 1995). Triangles
// are chosen by area x mean radiance (both sides emit), points uniformly on them. With the balance
// heuristic, a direction found by either strategy counts L cos / (p_light + p_cosine), p_cosine =
// cos / pi, and a sum over one sample of each is the irradiance.
#include "area_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace studio {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

float meanOf(const glm::vec3& c) {
    return (c.x + c.y + c.z) / 3.0f;
}

// Square to the triangle (0,0) (1,0) (0,1), areas kept and without a fold: E. Heitz, "A Low-Distortion
// Map Between Triangle and Square" (2019).
glm::vec2 onTriangle(glm::vec2 p) {
    if (p.y > p.x) return glm::vec2(0.5f * p.x, p.y - 0.5f * p.x);
    return glm::vec2(p.x - 0.5f * p.y, 0.5f * p.y);
}

}  // namespace

AreaLights::AreaLights(const RayScene& rayScene) {
    const Scene& scene = rayScene.scene();
    if (!scene.emissiveSurfaces) return;
    double power = 0.0;
    std::vector<double> upTo;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const Mesh& mesh = scene.meshes[m];
        const float radiance = meanOf(scene.materials[std::size_t(mesh.material)].emission);
        if (radiance <= 0.0f) continue;
        const glm::mat4 pose = scene.objects[std::size_t(mesh.object)].poseAt(rayScene.time());
        const auto corner = [&](unsigned vertex) {
            return glm::vec3(pose * glm::vec4(mesh.positions[vertex], 1.0f));
        };
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const glm::uvec3 v = mesh.triangles[t];
            const glm::vec3 a = corner(v.x), e1 = corner(v.y) - a, e2 = corner(v.z) - a;
            power += 0.5 * double(glm::length(glm::cross(e1, e2))) * double(radiance);
            upTo.push_back(power);
            triangles_.push_back({int(m), int(t), a, e1, e2, 0.0f});
        }
    }
    if (power <= 0.0) triangles_.clear();
    for (std::size_t i = 0; i < triangles_.size(); ++i) triangles_[i].upTo = upTo[i] / power;
    if (power > 0.0) perRadiance_ = float(1.0 / power);
}

float AreaLights::areaDensity(const glm::vec3& emission) const {
    return meanOf(emission) * perRadiance_;
}

AreaLights::Point AreaLights::pick(const glm::dvec2& fine) const {
    // One pair chooses the triangle and, with what is left of it, the point: it stays stratified.
    const auto chosen = std::upper_bound(triangles_.begin(), triangles_.end() - 1, fine.x,
                                         [](double x, const Triangle& t) { return x < t.upTo; });
    const double before = chosen == triangles_.begin() ? 0.0 : (chosen - 1)->upTo;
    const glm::vec2 weights =
        onTriangle(glm::vec2(glm::dvec2((fine.x - before) / (chosen->upTo - before), fine.y)));
    return {chosen->mesh, chosen->triangle, weights,
            chosen->corner + weights.x * chosen->edge1 + weights.y * chosen->edge2,
            glm::normalize(glm::cross(chosen->edge1, chosen->edge2))};
}

glm::vec3 AreaLights::weighted(const Surface& at, const glm::vec3& direction, const Hit& hit) const {
    const float cosine = glm::dot(at.normal, direction);
    const float emitterCosine = -glm::dot(hit.geometricNormal, direction);
    if (cosine <= 0.0f || emitterCosine <= 0.0f) return glm::vec3(0.0f);
    const float lightDensity = areaDensity(hit.emission) * hit.distance * hit.distance / emitterCosine;
    return hit.emission * (cosine / (lightDensity + cosine / kPi));
}

glm::vec3 AreaLights::emissionOfRay(const Surface& at, const glm::vec3& direction,
                                    const Hit& hit) const {
    return meanOf(hit.emission) > 0.0f ? weighted(at, direction, hit) : glm::vec3(0.0f);
}

glm::vec3 AreaLights::sampleIrradiance(const RayScene& scene, const Surface& at,
                                       Sampler& sampler) const {
    if (triangles_.empty()) return glm::vec3(0.0f);
    const Point chosen = pick(sampler.nextFine());
    const glm::vec3 origin = scene.offset(at.position, at.geometricNormal);
    const glm::vec3 towards = chosen.position - origin;
    const float distance = glm::length(towards);
    if (!(distance > 0.0f)) return glm::vec3(0.0f);
    const glm::vec3 direction = towards / distance;
    if (glm::dot(at.normal, direction) <= 0.0f || glm::dot(at.geometricNormal, direction) <= 0.0f)
        return glm::vec3(0.0f);

    // The triangle counts when it is what the ray meets first: no tolerance at the light's end, and
    // an alpha mask's holes are holes.
    Hit hit;
    if (!scene.trace(origin, direction, 0.0f, kFar, hit)) return glm::vec3(0.0f);
    if (hit.mesh != chosen.mesh || hit.triangle != chosen.triangle) return glm::vec3(0.0f);
    return weighted(at, direction, hit);
}

glm::vec3 extendedIrradiance(const RayScene& scene, const AreaLights& lights, const Surface& at,
                             Sampler& sampler) {
    const glm::vec3 sky = scene.scene().sky;
    if (lights.empty() && sky == glm::vec3(0.0f)) return glm::vec3(0.0f);

    const glm::vec3 irradiance = lights.sampleIrradiance(scene, at, sampler);
    const glm::vec3 direction = sampleCosine(at.normal, sampler.next());
    if (glm::dot(at.geometricNormal, direction) <= 0.0f) return irradiance;
    Hit hit;
    const glm::vec3 origin = scene.offset(at.position, at.geometricNormal);
    if (!scene.trace(origin, direction, 0.0f, kFar, hit)) return irradiance + kPi * sky;
    return irradiance + lights.emissionOfRay(at, direction, hit);
}

}  // namespace studio
