// A lamp's position against the cameras of its RSMs.
#include <cmath>

#include "inputs/input_check_parts.h"

namespace lightwell {
namespace {

// An RSM's camera off its light by this share of the distance to what it lights.
constexpr double kLightOffset = 0.02;

}  // namespace

void checkLightCamera(const LightMaps& light, Findings& findings) {
    const LWLight& l = *light.light;
    const glm::dvec3 place(l.position[0], l.position[1], l.position[2]);
    if (l.kind == LW_LIGHT_DIRECTIONAL || place == glm::dvec3(0.0))
        return;  // zero: analytic data may be absent
    for (const Surfaces& map : light.maps) {
        if (!map.camera || !map.camera->perspective() || !map.trusted) continue;
        const glm::dvec3 eye = map.camera->eye();
        std::vector<double> distances;
        map.sample([&](std::uint32_t x, std::uint32_t y) {
            if (map.surface(x, y)) distances.push_back(glm::length(map.position.triple(x, y) - eye));
        });
        const double typical = medianOf(std::move(distances)), offset = glm::length(eye - place);
        if (!(typical > 0.0) || offset <= kLightOffset * typical + map.rounding(place)) continue;
        const double ratio = glm::length(place) > 0.0 ? glm::length(eye) / glm::length(place) : 0.0;
        const bool along = glm::length(eye) > 0.0 &&
                           glm::dot(eye, place) > 0.999 * glm::length(eye) * glm::length(place);
        const char* const units = along ? lengthFactorName(1.0 / ratio) : nullptr;
        findings.add(
            LW_FAULT_LIGHT_CAMERA, LW_SEVERITY_WARNING, light.name + ".position",
            {1, 1, offset, 0.0, units ? 0.95 : 0.8}, "the camera of ", map.name, " is ", offset,
            " away from the light's position, which is ", typical, " from what it lights. ",
            units ? std::string("The RSM's camera is at ") + std::to_string(ratio) +
                        " times the light's position: other units of length (" + units + ")"
                  : std::string("The RSM must be drawn from where the light is, in the same space"));
        return;
    }
}

}  // namespace lightwell
