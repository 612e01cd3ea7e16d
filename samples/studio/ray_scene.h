// The scene as Embree sees it at one time: intersection with alpha masks, and what a hit looks like.
#pragma once

#include <memory>

#include <glm/glm.hpp>

#include "scene.h"

struct RTCSceneTy;

namespace studio {

struct Hit {
    float distance = 0.0f;
    glm::vec3 position{0.0f};
    glm::vec3 geometricNormal{0.0f};  // unit, on the ray's side
    glm::vec3 normal{0.0f};           // shading normal, unit, on the same side as geometricNormal
    glm::vec3 albedo{0.0f};
    glm::vec3 emission{0.0f};         // radiance towards the ray (both sides emit); 0 unless enabled
    int mesh = -1, triangle = -1;
    float u = 0.0f, v = 0.0f;         // barycentric weights of the second and third vertex
};

// Thread-safe for const use.
class RayScene {
public:
    RayScene(std::shared_ptr<const Scene> scene, float time);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    const Scene& scene() const;
    float time() const;
    // Differs from every other RayScene's of this process, gone or not: for tables made of one.
    std::uint64_t id() const;
    float diagonal() const;  // of the bounding box
    // Bounds of all triangles at this time in the coordinates `axes * position`.
    void boundsAlong(const glm::mat3& axes, glm::vec3& lower, glm::vec3& upper) const;

    // Nearest surface along a unit direction, from `from` (m) on; false when the ray leaves the scene.
    bool trace(const glm::vec3& origin, const glm::vec3& direction, float from, float to, Hit& hit) const;
    bool occluded(const glm::vec3& origin, const glm::vec3& direction, float from, float to) const;
    // Embree's scene, for callers that trace packets; geometry i is Scene::meshes[i].
    RTCSceneTy* embree() const;
    // Origin moved off a surface along its geometric normal, by a bias relative to its coordinates.
    glm::vec3 offset(const glm::vec3& position, const glm::vec3& geometricNormal) const;
    // Shadow rays stop short of a punctual light by this share of their length.
    static constexpr float kLightGap = 1e-5f;
    // offset() moves by kRelativeOffset of the largest of the coordinates and offsetFloor().
    static constexpr float kRelativeOffset = 1e-5f;
    float offsetFloor() const;

    // The scene's punctual lights at this time.
    const std::vector<Light>& lights() const;
    // Direct irradiance at a surface from one of them, and from all, with shadow rays. A surface facing
    // away (by geometric or shading normal) gets 0.
    glm::vec3 directIrradiance(const Light& light, const glm::vec3& position,
                               const glm::vec3& geometricNormal, const glm::vec3& normal) const;
    glm::vec3 directIrradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                               const glm::vec3& normal) const;
    // World position of the same surface point (mesh, triangle, u, v) at another time.
    glm::vec3 surfacePointAt(const Hit& hit, float otherTime) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace studio
