// What tools know of technique static_vpl's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& staticVplParameters();
const std::vector<LWSetting>& staticVplSettings();

}  // namespace lightwell
