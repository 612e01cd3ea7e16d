// Points that punctual lights shine on, found from the lights: the other end of a path tracer's paths.
#pragma once

#include <vector>

#include "area_lights.h"
#include "seen_surfaces.h"

namespace studio {

class LitPoints {
public:
    struct Point {
        Surface surface;  // on the lit side
        glm::vec3 albedo{0.0f};
        std::size_t light = 0;
        float density = 0.0f;  // see density()
    };

    // Points that matter to `receivers` are found more often; with `occlusion`, those that they see;
    // with `senders`, those among them.
    LitPoints(const RayScene& scene, const std::vector<Surface>& receivers, bool occlusion,
              const SeenSurfaces* senders = nullptr);
    // The same choice of rays in another scene, or in this one at another time, so that a frame's points are
    // those of `like` moved with their lights. Throws std::invalid_argument unless both have as many lights.
    LitPoints(const RayScene& scene, const LitPoints& like);
    bool empty() const { return probability_.empty(); }
    std::uint64_t hash() const;  // of the choice

    // False when the light's ray meets nothing.
    bool sample(Sampler& sampler, Point& point) const { return sample(sampler.nextFine(), point); }
    bool sample(const glm::dvec2& fine, Point& point) const;
    // Density per area of surface with which sample() finds a point by a light that shines on it.
    float density(std::size_t light, const glm::vec3& position, const glm::vec3& geometricNormal) const;

private:
    struct Ray {
        glm::vec3 origin, direction;
    };
    // A light's rays, laid out on the unit square so that equal areas carry equal measure: area across
    // a sun's rays (m^2), solid angle about other lights (sr).
    struct Chart {
        Light light;
        glm::dvec3 right, up, back;         // axes; rays run about -back
        glm::dvec2 lower{0.0}, upper{0.0};  // sun: bounds of the scene along the axes
        double nearBack = 0.0;              // sun: where its rays begin
        double cap = 0.0;                   // others: 1 - cos of the widest angle from -back
        double measure = 0.0;

        Chart(const RayScene& scene, const Light& chartLight);
        Ray rayAt(glm::dvec2 square) const;
        glm::dvec2 squareOf(const glm::vec3& position) const;
        double measurePerArea(const glm::vec3& position, const glm::vec3& geometricNormal) const;
    };
    // Light that `hit`, which stands for an area, sends to the judges, per flux.
    double transfer(const Hit& hit, double area, const std::vector<Surface>& judges,
                    bool occlusion) const;
    void chooseCells(const std::vector<double>& flux, const std::vector<double>& useful);

    const RayScene& scene_;
    std::vector<Chart> charts_;
    std::vector<double> probability_, upTo_;  // of each cell of each chart, and running sums
};

}  // namespace studio
