// The bounded gather of many point lights, cut down to what decides between widths: a loop with uniform
// loads, a division, multiply-adds and one store per pixel. Timed at widths 1, 8 and 16 to choose one.
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels. `lights`: x, y, z and bound, 16 lights, read over and over.
__kernel void probe_gather(__global const float* pixels, __global const float* lights, int count,
                           __global float* out) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(pixels, i);
    const real y = 0.5f * x + 1.0f, z = 0.25f * x - 1.0f;
    real sum = (real)(0.0f);
    for (int k = 0; k < count; ++k) {
        __global const float* light = lights + 4 * (k & 15);
        const real dx = light[0] - x, dy = light[1] - y, dz = light[2] - z;
        const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
        const real facing = fmax(fma_(dx, 0.6f, dy * 0.8f), 0.0f) * fmax(-fma_(dz, 0.8f, dx * 0.6f), 0.0f);
        const real q = 1.0f / (d2 + light[3]);
        sum = fma_(facing * q, q, sum);
    }
    store(sum, out, i);
}
