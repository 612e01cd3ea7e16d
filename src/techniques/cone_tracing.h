// Technique "cone_tracing": the scene as lit voxels, followed in cones (Crassin et al. 2011). docs/techniques/cone_tracing.md.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& coneTracingEntry();

}  // namespace lightwell
