// The table of technique screen_space's parameters, and its named settings.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& screenSpaceParameters();
const std::vector<LWSetting>& screenSpaceSettings();

}  // namespace lightwell
