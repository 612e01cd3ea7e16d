// Checks of what scene files say; see checkScene.
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "scene_import.h"

namespace studio {
namespace {

constexpr float kWidestView = 175.0f * kPi / 180.0f;  // a pinhole's picture ends before 180 degrees
// Cones read as degrees and written as radians end a little beside the right angle.
constexpr float kWidestCone = 0.5f * kPi * 1.000001f;

std::string text(const glm::vec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}

// One part of the file, named in every complaint.
class Part {
public:
    Part(const Scene& scene, const char* kind, const std::string& name)
        : where_(fmt::format("{}: {} \"{}\"", scene.path, kind, name)) {}

    template <class T>
    void require(bool holds, const char* field, const std::string& expected, const T& came) const {
        if (!holds)
            throw std::runtime_error(
                fmt::format("{}: {}: expected {}, got {}", where_, field, expected, came));
    }
    void requireFinite(const char* field, const glm::vec3& v) const {
        require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), field, "finite numbers",
                text(v));
    }
    // Each number in [0, most].
    void requireWithin(const char* field, const glm::vec3& v, float most) const {
        const auto within = [&](float x) { return std::isfinite(x) && x >= 0.0f && x <= most; };
        require(
            within(v.x) && within(v.y) && within(v.z), field,
            std::isinf(most) ? "finite numbers, 0 or more" : fmt::format("numbers from 0 to {}", most),
            text(v));
    }

private:
    std::string where_;
};

void checkMaterial(const Scene& scene, const Material& m) {
    const Part part(scene, "material", m.name);
    part.requireWithin("base colour", m.albedo, 1.0f);
    part.requireWithin("emission", m.emission, INFINITY);
    part.require(m.alphaCutoff >= 0.0f && std::isfinite(m.alphaCutoff), "alpha cutoff",
                 "a number, 0 or more", m.alphaCutoff);
}

void checkCamera(const Scene& scene, const Camera& c) {
    const Part part(scene, "camera", c.name);
    part.requireFinite("position", c.position);
    part.requireFinite("target", c.target);
    part.requireFinite("up", c.up);
    // In double: squares of small lengths are beyond floats.
    const glm::dvec3 way = glm::dvec3(c.target) - glm::dvec3(c.position), up(c.up);
    part.require(glm::length(glm::cross(way, up)) > 1e-4 * glm::length(way) * glm::length(up), "target",
                 "a point away from the position and off the up axis", text(c.target));
    part.require(c.verticalFov > 0.0f && c.verticalFov <= kWidestView, "vertical field of view",
                 fmt::format("an angle above 0 and at most {:.4g}", kWidestView), c.verticalFov);
    part.require(c.aspect >= 0.0f && std::isfinite(c.aspect), "aspect ratio",
                 "a number, 0 (any) or more", c.aspect);
    part.require(c.nearPlane > 0.0f && std::isfinite(c.nearPlane), "near plane", "a distance above 0",
                 c.nearPlane);
    part.require(c.farPlane > c.nearPlane, "far plane",
                 fmt::format("a distance above the near plane's, {}", c.nearPlane), c.farPlane);
}

void checkLight(const Scene& scene, const Light& l) {
    const Part part(scene, "light", l.name);
    part.requireFinite("position", l.position);
    part.require(std::abs(glm::length(l.direction) - 1.0f) < 1e-3f, "direction",
                 "a direction (not zero)", text(l.direction));
    part.requireWithin(l.kind == LightKind::Sun ? "irradiance" : "intensity", l.emitted, INFINITY);
    if (l.kind != LightKind::Spot) return;
    part.require(l.outerCone > 0.0f && l.outerCone <= kWidestCone, "outer cone",
                 "half of an angle, above 0 and at most pi/2", l.outerCone);
    part.require(l.innerCone >= 0.0f && l.innerCone <= l.outerCone, "inner cone",
                 fmt::format("half of an angle from 0 to the outer one, {}", l.outerCone), l.innerCone);
}

}  // namespace

void checkScene(const Scene& scene) {
    for (const Material& material : scene.materials) checkMaterial(scene, material);
    for (const Camera& camera : scene.cameras) checkCamera(scene, camera);
    for (const auto& track : scene.cameraTracks)
        for (const auto& key : track.keys) checkCamera(scene, key.second);
    for (const Light& light : scene.lights) checkLight(scene, light);
    for (const auto& track : scene.lightTracks)
        for (const auto& key : track.keys) checkLight(scene, key.second);
}

}  // namespace studio
