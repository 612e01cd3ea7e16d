#include "inputs/input_light.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

double coneFalloff(const LWLight& light, const glm::dvec3& way) {
    if (light.kind != LW_LIGHT_SPOT) return 1.0;
    const glm::dvec3 axis(light.direction[0], light.direction[1], light.direction[2]);
    const double length = glm::length(axis);
    if (!(length > 0.0)) return 1.0;
    // KHR_lights_punctual.
    const double cosine = glm::dot(way, axis / length), inner = std::cos(double(light.innerConeAngle)),
                 outer = std::cos(double(light.outerConeAngle));
    const double ramp = std::min(1.0, std::max(0.0, (cosine - outer) / std::max(1e-3, inner - outer)));
    return ramp * ramp;
}

glm::dvec3 emitted(const LWLight& light) {
    const float* v = light.kind == LW_LIGHT_DIRECTIONAL ? light.irradiance : light.radiantIntensity;
    return {double(v[0]), double(v[1]), double(v[2])};
}

glm::dvec3 incidentFlux(const LWLight& light, const Surfaces& map, std::uint32_t x, std::uint32_t y) {
    const Camera& camera = *map.camera;
    if (!camera.perspective()) return emitted(light) * camera.pixelArea();
    const glm::dvec3 ray = camera.rays().at(x, y);  // 1 long along the axis
    const double length = glm::length(ray);
    return emitted(light) *
           (coneFalloff(light, ray / length) * camera.pixelArea() / (length * length * length));
}

}  // namespace lightwell
