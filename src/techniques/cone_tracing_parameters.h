// What tools know of technique cone_tracing's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& coneTracingParameters();
const std::vector<LWSetting>& coneTracingSettings();

}  // namespace lightwell
