// Rays of a punctual light, spread evenly over all that it sends: photons of instant radiosity, paths that
// look for what a light reaches.
#pragma once

#include "ray_scene.h"

namespace studio {

struct LightRay {
    glm::vec3 origin{0.0f}, direction{0.0f};  // direction: unit
};

// A light's rays laid out on the unit square so that equal areas carry equal measure: area across a sun's
// rays (m^2; those that meet the scene's bounds), solid angle of a spot's outer cone or about a point light
// (sr). The middle of the square is the light's axis. Axes follow the light's direction by the shortest turn
// from straight down, so that a pattern sweeps along with a light and jumps nowhere but straight up.
class LightRays {
public:
    LightRays(const RayScene& scene, const Light& light);
    LightRay at(const glm::dvec2& square) const;
    const Light& light() const { return light_; }
    double measure() const { return measure_; }
    // Flux per measure that a ray carries: W/m^2 of a sun, W/sr of other lights.
    glm::vec3 strength(const LightRay& ray) const;
    // Measure per area of surface, at a distance, of cosine 1: 1 of a sun, else 1 / distance^2.
    double measurePerArea(double distance) const;

private:
    Light light_;
    glm::dvec3 right_, up_, forward_;
    glm::dvec2 lower_{0.0}, upper_{0.0};  // sun: the scene's bounds along right and up
    double start_ = 0.0;                  // sun: along forward, before the scene
    double cap_ = 0.0;                    // others: 1 - cos of the widest angle from the axis
    double measure_ = 0.0;
};

}  // namespace studio
