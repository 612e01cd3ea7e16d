// The device's measured peak rates, against which passes state their share.
#pragma once

#include "compute/binary_store.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class Device;

// Multiply-add rate of a register-resident loop and bandwidth of a triad over memory larger than the
// caches; best of several runs, under two seconds in all.
LWRoofline probeRoofline(Device& device);

// The same, measured when the device is first asked, then kept with it and beside its programs on disk. A file there that is
// damaged, or holds no rates, is replaced, and logged.
const LWRoofline& knownRoofline(Device& device);
// Measured now, and kept in place of what was known.
const LWRoofline& renewRoofline(Device& device);
// Of this device, driver and library, in the store that holds the device's programs.
StoreKey rooflineKey(const Device& device);

}  // namespace lightwell
