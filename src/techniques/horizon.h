// Technique "horizon": ambient occlusion and light of one bounce from the view's own pixels, slice by slice with a
// visibility bitmask (Therrien et al. 2023) of sectors of equal measure. docs/techniques/horizon.md derives it.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& horizonEntry();

}  // namespace lightwell
