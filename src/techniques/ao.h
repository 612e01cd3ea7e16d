// Technique "ao": screen-space ambient occlusion (SSAO) and directional occlusion (SSDO), the older estimators that
// "horizon" is measured against. docs/techniques/ao.md.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& aoEntry();

}  // namespace lightwell
