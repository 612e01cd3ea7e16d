// Areas of static VPLs that have none of their own: a disc that reaches half-way to the nearest other place
// (Papaioannou 2025, section 5.1: pi d^2 / 4, whose discs do not overlap, not section 4.1's).
#include "shared/static_vpl_types.h"
#include "shared/wide.h"

// One work-item = LW_WIDTH places from `first` (a multiple of 16) on, up to `end`: each against all. Every place is
// compared whole in one frame, so that one round at rest makes all exact, wherever in it they came to rest.
__kernel void static_vpl_weights_nearest(__global const float* inputs, lw_static_frame frame, int first, int end,
                                         __global float* areas) {
    const int i = first + (int)get_global_id(0) * LW_WIDTH;
    if (i >= end) return;
    __global const float* places = inputs + frame.places;
    const real x = load(places, i), y = load(places, i + frame.stride), z = load(places, i + 2 * frame.stride);
    const lanei own = lanei_iota() + (lanei)i;
    real nearest = (real)INFINITY;
    for (int j = 0; j < frame.count; ++j) {
        const real dx = x - places[j], dy = y - places[j + frame.stride], dz = z - places[j + 2 * frame.stride];
        const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
        nearest = select_(fmin(nearest, d2), nearest, own == (lanei)j);
    }
    // A place that is alone has no other: it stands for nothing.
    nearest = select_(nearest, (real)0.0f, nearest == (real)INFINITY);
    store(select_(nearest * (M_PI_F / 4.0f), (real)0.0f, own >= (lanei)frame.count), areas, i);
}
