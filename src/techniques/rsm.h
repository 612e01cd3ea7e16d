// Technique "rsm": virtual point lights drawn from reflective shadow maps, gathered without visibility
// (Dachsbacher & Stamminger 2005), interleaved (Segovia et al. 2006). docs/techniques/rsm.md derives it.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& rsmEntry();

}  // namespace lightwell
