// What tools know of technique rsm's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& rsmParameters();
const std::vector<LWSetting>& rsmSettings();

}  // namespace lightwell
