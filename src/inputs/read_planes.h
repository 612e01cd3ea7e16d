// Device planes copied to the host, for debug views.
#pragma once

#include "compute/buffer.h"

namespace lightwell {

class Device;

// Blocks. Writes planes.count planes of width * height floats, packed.
void readPlanes(Device& device, const Planes& planes, float* pixels);

}  // namespace lightwell
