// What tools know of technique ao's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& aoParameters();
const std::vector<LWSetting>& aoSettings();

}  // namespace lightwell
