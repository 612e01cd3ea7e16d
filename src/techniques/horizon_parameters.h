// What tools know of technique horizon's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& horizonParameters();
const std::vector<LWSetting>& horizonSettings();

}  // namespace lightwell
