// Technique "static_vpl": places of the scene that the host chose become VPLs by each frame's lights,
// past soft spheres (Papaioannou 2025); phantom VPLs of spot lights; the same as a list of lights.
// docs/techniques/static_vpl.md derives it.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& staticVplEntry();

}  // namespace lightwell
