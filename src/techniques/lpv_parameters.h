// What tools know of technique lpv's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& lpvParameters();
const std::vector<LWSetting>& lpvSettings();

}  // namespace lightwell
