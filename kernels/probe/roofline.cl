// The device's peak rates: multiply-adds that stay in registers, a triad that streams memory, and an
// almost empty kernel whose launches are counted.
#include "shared/wide.h"

// Independent chains: enough to cover the latency (4 cycles) of two multiply-add units.
#define LW_CHAINS 12

// One work-item = LW_WIDTH lanes of LW_CHAINS chains, 2 * LW_CHAINS * LW_WIDTH operations per step.
// With |a| < 1 the chains converge, so no value overflows or becomes denormal.
__kernel void probe_multiply_add(float a, float b, int steps, __global float* out) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real scale = (real)(a), offset = (real)(b);
    real c[LW_CHAINS];
#pragma unroll
    for (int k = 0; k < LW_CHAINS; ++k) c[k] = lane_iota() + (float)k;
    for (int s = 0; s < steps; ++s) {
#pragma unroll
        for (int k = 0; k < LW_CHAINS; ++k) c[k] = fma_(c[k], scale, offset);
    }
    real sum = (real)(0.0f);
#pragma unroll
    for (int k = 0; k < LW_CHAINS; ++k) sum += c[k];
    store(sum, out, i);
}

// One work-item = LW_WIDTH floats of out = x + s * y: 12 bytes moved for each.
__kernel void probe_triad(__global const float* x, __global const float* y, float s, __global float* out) {
    const size_t i = get_global_id(0) * LW_WIDTH;
    store(fma_(load(y, i), s, load(x, i)), out, i);
}

// One work-item = one float.
__kernel void probe_launch(__global float* value) {
    if (get_global_id(0) == 0) value[0] += 1.0f;
}
