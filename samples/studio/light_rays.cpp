// See light_rays.h.
#include "light_rays.h"

#include <algorithm>
#include <cmath>

namespace studio {
namespace {

// Share of the diagonal by which a sun's rays start before the scene.
constexpr double kMargin = 1e-3;

// The shortest turn from straight down to `to`, applied to `v` (Rodrigues's formula; straight up turns about x).
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& to) {
    const glm::dvec3 down(0.0, -1.0, 0.0);
    const double cosine = glm::dot(down, to);
    if (cosine < -1.0 + 1e-12) return {v.x, -v.y, -v.z};
    const glm::dvec3 axis = glm::cross(down, to);
    return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1.0 + cosine));
}

// Square to unit disc, areas and neighbourhoods kept (P. Shirley and K. Chiu 1997): radius and angle.
glm::dvec2 concentric(const glm::dvec2& square) {
    const glm::dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0.0 && p.y == 0.0) return glm::dvec2(0.0);
    constexpr double quarter = 0.25 * 3.14159265358979323846;
    if (std::abs(p.x) > std::abs(p.y)) return {p.x, quarter * (p.y / p.x)};
    return {p.y, quarter * (2.0 - p.x / p.y)};
}

}  // namespace

LightRays::LightRays(const RayScene& scene, const Light& light) : light_(light) {
    // A point light has no direction of its own: straight down will do.
    forward_ = light.kind == LightKind::Point ? glm::dvec3(0.0, -1.0, 0.0)
                                              : glm::normalize(glm::dvec3(light.direction));
    right_ = turned({1.0, 0.0, 0.0}, forward_);
    up_ = turned({0.0, 0.0, -1.0}, forward_);
    if (light.kind != LightKind::Sun) {
        cap_ = light.kind == LightKind::Point ? 2.0 : 1.0 - std::cos(double(light.outerCone));
        measure_ = 2.0 * double(kPi) * cap_;
        return;
    }
    const glm::mat3 rows(glm::transpose(glm::dmat3(right_, up_, forward_)));
    glm::vec3 low, high;
    scene.boundsAlong(rows, low, high);
    lower_ = glm::dvec2(low), upper_ = glm::dvec2(high);
    start_ = double(low.z) - kMargin * double(scene.diagonal());
    measure_ = (upper_.x - lower_.x) * (upper_.y - lower_.y);
}

LightRay LightRays::at(const glm::dvec2& square) const {
    if (light_.kind == LightKind::Sun) {
        const glm::dvec2 p = lower_ + (upper_ - lower_) * square;
        return {glm::vec3(right_ * p.x + up_ * p.y + forward_ * start_), light_.direction};
    }
    // Equal areas of the disc are equal heights of the sphere's cap (Archimedes).
    const glm::dvec2 disc = concentric(square);
    const double cosine = 1.0 - cap_ * disc.x * disc.x;
    const double sine = std::copysign(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), disc.x);
    const glm::dvec3 direction =
        (right_ * std::cos(disc.y) + up_ * std::sin(disc.y)) * sine + forward_ * cosine;
    return {light_.position, glm::vec3(glm::normalize(direction))};
}

glm::vec3 LightRays::strength(const LightRay& ray) const {
    return light_.emitted * coneFalloff(light_, ray.direction);
}

double LightRays::measurePerArea(double distance) const {
    return light_.kind == LightKind::Sun ? 1.0 : 1.0 / (distance * distance);
}

}  // namespace studio
