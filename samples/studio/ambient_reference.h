// The truth of ambient occlusion: how much of a pixel's hemisphere no surface within a radius covers.
#pragma once

#include "film.h"
#include "reference_run.h"

namespace studio {

// A film of one layer, "ambient": 1 = open, in all three channels. Directions under the pixel's own
// surface are covered.
Film traceAmbient(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                  const PathTracerOptions& options);

}  // namespace studio
