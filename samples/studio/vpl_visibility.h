// Irradiance from virtual point lights with exact visibility.
#pragma once

#include "area_lights.h"
#include "path_tracer.h"

namespace studio {

// Irradiance of `vpl` at `at` by the bounded geometry term, whatever stands between:
//     E = Phi/pi c_p c / (d^2 + (1 + 3 c_p^2)/4 A/pi),
// c_p, c the cosines at the VPL and at the surface (shading normal). In double: the truth of kernels.
glm::dvec3 vplIrradiance(const VplRecord& vpl, const Surface& at);

bool vplVisible(const RayScene& scene, const VplRecord& vpl, const Surface& at);

}  // namespace studio
