// Light in two bands of spherical harmonics as passes write it.
#pragma once

#include "compute/buffer.h"
#include "compute/cl.h"

namespace lightwell {

// c0, c1.x, c1.y, c1.z of three colours at the points of an image of them (kernels/shared/points.h).
struct Harmonics {
    Planes first;     // c0, a plane for each colour
    cl_int band = 0;  // floats from one band's planes to the next one's
    explicit operator bool() const { return bool(first); }
};

}  // namespace lightwell
