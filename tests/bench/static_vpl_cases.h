// Benchmarks of technique static_vpl: what a frame costs a host that has no picture to hand over.
#pragma once

#include "lightwell/lightwell.h"

namespace bench {

// static_vpl.update.nN: lwUpdate and lwFinish, on the host's clock. static_vpl.lights.nN: lwUpdate and
// lwReadLightList, so from the host's lights to its light list. N places in a room, a lamp, a torch and
// a sun, 50 blockers. device_us: what kernels and copies took.
void registerStaticVplCases(LWDevice device);

}  // namespace bench
