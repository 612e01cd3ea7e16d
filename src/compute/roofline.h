// The device's measured peak rates, against which passes state their share.
#pragma once

#include "lightwell/lightwell.h"

namespace lightwell {

class Device;

// Multiply-add rate of a register-resident loop and bandwidth of a triad over memory larger than the
// caches; best of several runs, under two seconds in all.
LWRoofline probeRoofline(Device& device);

}  // namespace lightwell
