// Technique "ssvp": VPLs from reflective shadow maps in clusters, each cluster's visibility in a paraboloid map, a second
// bounce drawn from the maps (Aranha et al. 2020). docs/techniques/ssvp.md derives it.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& ssvpEntry();

}  // namespace lightwell
