// The truth of radiance along glossy lobes: what the first surface along a mirrored ray sends back of
// the lamps' light.
#pragma once

#include "film.h"
#include "reference_run.h"

namespace studio {

// A film of one layer, "specular": radiance (W/(sr m^2)) in the mean over the GGX lobe of alpha =
// roughness^2 (Walter et al. 2007) about the mirrored view direction, each direction l weighted by n.l,
// as LWOutput::specularRadiance has it. A ray that meets a surface brings albedo / pi times the
// irradiance there by punctual lights, one that meets none the sky. What emissive surfaces and the sky
// light is left out.
Film traceSpecular(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                   const PathTracerOptions& options);

}  // namespace studio
