// What tools know of technique auto.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& autoParameters();

}  // namespace lightwell
