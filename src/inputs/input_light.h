// A light's emission as conventions.md defines it, in double precision for the checker.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "inputs/input_surfaces.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// E_perp or intensity; zero where the host gives none.
glm::dvec3 emitted(const LWLight& light);
// Share of the intensity towards the unit vector `way`.
double coneFalloff(const LWLight& light, const glm::dvec3& way);
// Flux through a texel.
glm::dvec3 incidentFlux(const LWLight& light, const Surfaces& map, std::uint32_t x, std::uint32_t y);

}  // namespace lightwell
