// A frame's source views, as all that read them name and measure them.
#pragma once

#include <cstdint>
#include <string>

#include "inputs/view.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// "frame.sourceViews[i].gbuffer", which begins every error about it.
std::string sourceViewName(std::uint32_t i);

// Its size: the images of a source view have one, that of its normals. Throws INVALID_ARGUMENT where there are none, or more than
// 16,384 a side.
View sourceViewOf(const LWFrame& frame, std::uint32_t i);

}  // namespace lightwell
