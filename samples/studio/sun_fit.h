// Which part of a sun's shadow-map plane holds the surfaces that light a view.
#pragma once

#include <vector>

#include "gbuffer.h"

namespace studio {

// Right-handed axes of a light: the view looks along -back, as cameras do.
struct LightAxes {
    glm::dvec3 right, up, back;
    explicit LightAxes(const glm::vec3& direction);
    LightAxes(const glm::dvec3& forward, const glm::dvec3& upwards)  // unit, at right angles
        : right(glm::cross(forward, upwards)), up(upwards), back(-forward) {}
    glm::mat3 rows() const;  // world -> light, rotation only
};

// A rectangle of the plane through the world's origin facing the sun, in metres along LightAxes.
struct SunRect {
    glm::dvec2 lower{0.0}, upper{0.0};
    glm::dvec2 size() const { return upper - lower; }
};

struct SunFit {
    std::vector<SunRect> cascades;         // finest first; edges lie on texel edges of the next
    double nearBack = 0.0, farBack = 0.0;  // the scene's extent along LightAxes::back, nearBack larger
};

SunFit fitSun(const RayScene& scene, const Light& light, const RsmOptions& options);

}  // namespace studio
