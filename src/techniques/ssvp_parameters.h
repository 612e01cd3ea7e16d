// What tools know of technique ssvp's descriptor.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWParameter>& ssvpParameters();
const std::vector<LWSetting>& ssvpSettings();

}  // namespace lightwell
