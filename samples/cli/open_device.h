#pragma once

#include <cstdint>
#include <string>

#include "lightwell/lightwell.hpp"

namespace cli {

// `selector` as LWDeviceDesc::selector ("" = its default), `width` 0 = by probe. An unknown selector
// is a UsageError that lists the devices.
lightwell::Device openDevice(const std::string& selector, std::uint32_t width);

}  // namespace cli
