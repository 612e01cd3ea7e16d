// Every form of the dialect, one kernel per section of wide.h. Pixel-wise forms give the same values at any
// width; forms across lanes are stored per work-item.
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels; out: planes of `count`. Offsets 1 and 3 are deliberately unaligned.
__kernel void wide_memory(__global const float* floats, __global const int* ints, __global const uchar* bytes,
                          __global const int* indices, int count, __global float* out, __global int* outInts) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const lanei at = loadi(indices, i);
    store(load(floats, i + 1), out, i);
    store(gather(floats, at), out + count, i);
    store(to_real(load(bytes, i + 3)), out + 2 * count, i);
    scatter(load(floats, i), out + 3 * count, at);
    will_load(floats + 1000000);  // no memory of ours
    store(load_whole(floats + i + 1), out + 4 * count, i);
    store_past(load(floats, i), out + 5 * count, i);
    store_past(load(floats, i), out + 6 * count + 1, i);
    store(loadi(ints, i + 3), outInts, i);
    store(gatheri(ints, at), outInts + count, i);
}

// One work-item = LW_WIDTH pixels; out: planes of `count` with 1 where a mask is true, else 0; whole: any_,
// all_, count_ and bits_ of x < y per work-item.
__kernel void wide_masks(__global const float* xs, __global const float* ys, __global const int* ints, int count,
                         __global float* out, __global int* outInts, __global int* whole) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(xs, i), y = load(ys, i);
    const lanei n = loadi(ints, i);
    const laneu u = to_laneu(n & 1023);
    const mask less = x < y;
    const mask even = (n & 1) == 0;
    store(ones_(less), out, i);
    store(ones_(not_(less)), out + count, i);
    store(ones_(not_(not_(less))), out + 2 * count, i);
    store(ones_(and_(less, even)), out + 3 * count, i);
    store(ones_(or_(less, even)), out + 4 * count, i);
    store(ones_(and_(less, not_(even))), out + 5 * count, i);
    store(ones_(to_mask(n)), out + 6 * count, i);
    store(ones_(to_mask(u)), out + 7 * count, i);
    store(ones_(splat_mask(count > 0)), out + 8 * count, i);
    store(ones_(splat_mask(count < 0)), out + 9 * count, i);
    store(ones_(isfinite_(x)), out + 10 * count, i);
    store(select_(x, y, even), out + 11 * count, i);
    store(selecti_(n, -n, less), outInts, i);
    store(to_lanei(selectu_(u, u + 5u, less)), outInts + count, i);
    const int group = (int)get_global_id(0);
    whole[4 * group] = any_(less);
    whole[4 * group + 1] = all_(less);
    whole[4 * group + 2] = count_(less);
    whole[4 * group + 3] = (int)bits_(less);
}

// One work-item = LW_WIDTH pixels.
__kernel void wide_convert(__global const float* floats, __global const int* ints, int count, __global float* out,
                           __global int* outInts) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(floats, i);
    const lanei n = loadi(ints, i);
    store(to_real(n), out, i);
    store(to_real(to_laneu(fabs(x))), out + count, i);
    store(as_real_(as_lanei_(x) ^ n), out + 2 * count, i);
    store(to_lanei(x), outInts, i);
    store(as_lanei_(x), outInts + count, i);
    store(as_real_(as_laneu_(x) >> 1), out + 3 * count, i);
}

// One work-item = 2 * LW_WIDTH pixels; scalars: min_lane, max_lane of the first LW_WIDTH; integers likewise, and the first.
__kernel void wide_lanes(__global const float* floats, __global const int* ints, int count, __global float* out,
                         __global float* scalars, __global int* outInts) {
    const int group = (int)get_global_id(0), i = 2 * LW_WIDTH * group;
    const real a = load(floats, i), b = load(floats, i + LW_WIDTH);
    const real e = even_(a, b), o = odd_(a, b);
    store(e, out, i);
    store(o, out, i + LW_WIDTH);
    store(zip_lo_(e, o), out + count, i);
    store(zip_hi_(e, o), out + count, i + LW_WIDTH);
    store(lane_iota(), out + 2 * count, i);
    store(to_real(lanei_iota()), out + 2 * count, i + LW_WIDTH);
    store(from_left_(a), out + 3 * count, i);
    store(from_right_(a), out + 3 * count, i + LW_WIDTH);
    scalars[2 * group] = min_lane(a);
    scalars[2 * group + 1] = max_lane(a);
    outInts[3 * group] = usually_(group >= 0) && !rarely_(count < 0) ? mini_lane(loadi(ints, i)) : 0;
    outInts[3 * group + 1] = maxi_lane(loadi(ints, i));
    outInts[3 * group + 2] = firsti_lane(loadi(ints, i));
}

// One work-item = LW_WIDTH pixels. `fused` tells whether fma_ is a fused multiply-add here.
__kernel void wide_arithmetic(__global const float* xs, __global const float* ys, __global const float* zs,
                              int count, __global float* out, __global int* fused) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(xs, i), y = load(ys, i), z = load(zs, i);
    store(fma_(x, y, z), out, i);
    store(fma_(2.0f, x, 1.0f), out + count, i);
    store(x * y + z, out + 2 * count, i);
    store(sq(x), out + 3 * count, i);
    store(fmin(fmax(x, y), (real)(0.5f)), out + 4 * count, i);
    store(sqrt(fabs(x)), out + 5 * count, i);
    store(x / (sq(y) + 0.5f), out + 6 * count, i);
#ifdef FP_FAST_FMAF
    if (i == 0) fused[0] = 1;
#else
    if (i == 0) fused[0] = 0;
#endif
}

// One work-item = LW_WIDTH pixels. Light gathered from a few points, part of it cut off by a looked-up
// visibility: loops, uniform branches, gathers, selects.
__kernel void wide_gather(__global const float* px, __global const float* py, __constant float* lights,
                          int lightCount, __global const float* field, int fieldMask, __global float* out) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(px, i), y = load(py, i);
    real e = (real)(0.0f);
    for (int k = 0; k < lightCount; ++k) {
        const real dx = lights[4 * k] - x, dy = lights[4 * k + 1] - y;
        const real d2 = fma_(dx, dx, fma_(dy, dy, (real)(lights[4 * k + 2])));
        const real q = 1.0f / (d2 + lights[4 * k + 3]);
        const lanei cell = (to_lanei(fabs(dx) * 37.0f) * 7 + to_lanei(fabs(dy) * 53.0f)) & fieldMask;
        const real w = select_(fmax(dx, 0.0f) * q, (real)(0.0f), gather(field, cell) * 4.0f < d2);
        e = fma_(w, q, e);
    }
    store(e, out, i);
}

// One work-item = LW_WIDTH pixels. A march that each lane leaves at its own step; the work-item leaves when
// none is left.
__kernel void wide_march(__global const float* px, __global const float* field, int fieldMask, int maxSteps,
                         __global float* out, __global float* outSteps) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const real x = load(px, i);
    real t = (real)(0.1f), sum = (real)(0.0f), opacity = (real)(0.0f), steps = (real)(0.0f);
    mask live = splat_mask(1);
    for (int s = 0; s < maxSteps; ++s) {
        const real f = gather(field, to_lanei((x + t) * 61.0f) & fieldMask);
        const real a = select_((real)(0.0f), (1.0f - opacity) * f, live);
        sum = fma_(a, t, sum);
        opacity += a;
        steps += ones_(live);
        t = select_(t, t * 1.3f, live);
        live = and_(live, and_(opacity < 0.95f, t < 9.0f));
        if (!any_(live)) break;
    }
    store(sum, out, i);
    store(steps, outSteps, i);
}

// The reasons for the rule of masks: what raw operators make of a mask that is true in every lane, beside
// the dialect's forms. One work-item.
__kernel void wide_traps(__global const float* xs, __global int* raw, __global int* forms) {
    const real x = load(xs, 0);
    const mask all = x == x;
#if LW_WIDTH == 1
    raw[0] = any(all);
    raw[1] = (~all) ? 1 : 0;
    raw[2] = (int)to_real(all);
#else
    raw[0] = any(all);
    raw[1] = any(~all) ? 1 : 0;
    raw[2] = (int)to_real(all).s0;
#endif
    forms[0] = any_(all);
    forms[1] = any_(not_(all));
    forms[2] = (int)max_lane(ones_(all));
    forms[3] = all_(all);
    forms[4] = count_(all);
    forms[5] = count_(not_(all));
    forms[6] = sum_(lanei_iota() - 3);
}
