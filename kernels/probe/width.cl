// The bounded gather of many point lights, cut down to what decides between widths: a loop with uniform
// loads, one division to some twenty multiply-adds, one store per pixel. Timed at widths 1, 8 and 16 to choose
// one. (With fewer multiply-adds the division decides alone, and 8 lanes tie with 16.)
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels. `lights`: x, y, z and bound, 16 lights, read over and over.
__kernel void probe_gather(__global const float* pixels, __global const float* lights, int count,
                           __global float* out) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(pixels, i);
    const real y = 0.5f * x + 1.0f, z = 0.25f * x - 1.0f;
    real r = (real)(0.0f), g = (real)(0.0f), b = (real)(0.0f);
    for (int k = 0; k < count; ++k) {
        __global const float* light = lights + 4 * (k & 15);
        const real dx = x - light[0], dy = y - light[1], dz = z - light[2];
        const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
        const real c = fmax(fma_(dx, x, fma_(dy, y, dz * z)), (real)(0.0f));
        const real cp = fmax(fma_(dx, 0.6f, fma_(dy, 0.48f, dz * 0.64f)), (real)(0.0f));
        const real q = c * cp / fma_(d2, d2, fma_(fma_(cp, cp, d2), light[3], 1e-37f));
        r = fma_(q, light[0], r);
        g = fma_(q, light[1], g);
        b = fma_(q, light[2], b);
    }
    const real sum = r + g + b;
    store(sum, out, i);
}
