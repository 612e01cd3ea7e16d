// Technique "screen_space": indirect light between the surfaces that the camera sees, gathered on the levels of the
// G-buffer's mip pyramid (Soler et al. 2009). docs/techniques/screen_space.md derives it.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& screenSpaceEntry();

}  // namespace lightwell
