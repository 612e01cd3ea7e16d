// Device planes copied to the host, for debug views.
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class Device;

// Writes planes.count planes of width * height floats, packed, when the queue gets there: `pixels` must
// last until then.
void enqueueReadPlanes(Executor& executor, const Planes& planes, float* pixels);

// The same, blocking.
void readPlanes(Device& device, const Planes& planes, float* pixels);

}  // namespace lightwell
