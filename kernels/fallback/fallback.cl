// Two techniques' light joined by what the first one vouches for: E = E1 + (1 - v1) E2.
#include "shared/input_limits.h"
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels. Irradiances: three planes each; validities: one. `hasIrradiance`, `hasValidity`: which of the
// joined planes are wanted; the others' arguments are not touched. saturated[0] counts pixels that were brought down.
__kernel void fallback_join(__global const float* first, int4 firstLayout, __global const float* firstValidity,
                            int4 firstValidityLayout, __global const float* second, int4 secondLayout,
                            __global const float* secondValidity, int4 secondValidityLayout, int width, int height,
                            int hasIrradiance, int hasValidity, __global float* irradiance, int4 irradianceLayout,
                            __global float* validity, int4 validityLayout, __global int* saturated) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const real v = load(firstValidity, firstValidityLayout.x + y * firstValidityLayout.y + x);
    const real unseen = clamp((real)1.0f - v, (real)0.0f, (real)1.0f);
    if (hasIrradiance) {
        const int a = firstLayout.x + y * firstLayout.y + x, b = secondLayout.x + y * secondLayout.y + x;
        const int e = irradianceLayout.x + y * irradianceLayout.y + x;
        real most = (real)0.0f;
        for (int c = 0; c < 3; ++c) {
            const real sum = fma_(unseen, load(second, b + c * secondLayout.z), load(first, a + c * firstLayout.z));
            most = fmax(most, sum);
            store(fmin(sum, (real)LW_LARGEST_IRRADIANCE), irradiance, e + c * irradianceLayout.z);
        }
        // Two irradiances at the limit add up to more than it.
        const mask above = (most > LW_LARGEST_IRRADIANCE), counted = and_(above, lanei_iota() + x < width);
        if (any_(counted)) atomic_add(saturated, count_(counted));
    }
    if (hasValidity) {
        const real w = load(secondValidity, secondValidityLayout.x + y * secondValidityLayout.y + x);
        store(fmin(fma_(unseen, w, v), (real)1.0f), validity, validityLayout.x + y * validityLayout.y + x);
    }
}

// The same of light at points in two bands of spherical harmonics. One work-item = LW_WIDTH points of a row. Each light: three
// colours' planes, `...Band` floats from one band's to the next one's.
__kernel void fallback_join_harmonics(__global const float* first, int4 firstLayout, int firstBand,
                                      __global const float* firstValidity, int4 firstValidityLayout,
                                      __global const float* second, int4 secondLayout, int secondBand, int width, int height,
                                      __global float* harmonics, int4 harmonicsLayout, int band) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const real v = load(firstValidity, firstValidityLayout.x + y * firstValidityLayout.y + x);
    const real unseen = clamp((real)1.0f - v, (real)0.0f, (real)1.0f);
    const int a = firstLayout.x + y * firstLayout.y + x, b = secondLayout.x + y * secondLayout.y + x,
              h = harmonicsLayout.x + y * harmonicsLayout.y + x;
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
            const real sum = fma_(unseen, load(second, b + k * secondBand + c * secondLayout.z),
                                  load(first, a + k * firstBand + c * firstLayout.z));
            store(clamp(sum, (real)-LW_LARGEST_IRRADIANCE, (real)LW_LARGEST_IRRADIANCE), harmonics,
                  h + k * band + c * harmonicsLayout.z);
        }
}
