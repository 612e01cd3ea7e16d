// Triangles as surfels, drawn by area: systematically along the triangles' order, which keeps neighbours together, and on a
// triangle by the additive recurrence of two dimensions (Roberts 2018). Both leave fewer and smaller gaps between the discs
// than independent places would: of the latter, discs that together cover a wall twice leave 13 % of it open. Whole numbers
// make it exact: the same triangles always give the same surfels.
#include "shared/geometry_types.h"
#include "shared/paraboloid_box.h"
#include "shared/surfel_types.h"

// 2^32 over the root of x^3 = x + 1 and over its square; odd.
#define LW_STEP_S 0xc13fa9a9u
#define LW_STEP_T 0x91e10da5u

LW_FN lw_direction corner_of(__global const float* triangles, int stride, int plane, lanei t) {
    const lw_direction v = {gather(triangles + plane * stride, t), gather(triangles + (plane + 1) * stride, t),
                            gather(triangles + (plane + 2) * stride, t)};
    return v;
}

// In [0, 1), of the upper 24 bits.
LW_FN real unit_of(laneu bits) { return to_real(bits >> 8) * (1.0f / 16777216.0f); }

// One work-item = LW_WIDTH surfels. `shares`: for each triangle the share of the area up to and with it, of 2^32, the last
// one's all of it; `steps`: halvings that find one among them. Surfel i lies at share (i + 1/2) 2^32 / count, where 2^32 / count
// is `spacing` 2^(shift - 31). Every surfel stands for a disc of `radius`.
__kernel void surfel_sampling_draw(__global const float* triangles, int triangleStride, __global const int* shares,
                                   int triangleCount, int steps, uint spacing, int shift, float radius, int count,
                                   __global float* surfels, int stride) {
    const int first = (int)get_global_id(0) * LW_WIDTH;
    if (first >= stride) return;
    const lanei index = lanei_iota() + first;
    const laneu i = to_laneu(index);
    // The first triangle whose share exceeds the sample's.
    const laneu wanted = (mul_hi(i << (uint)shift, (laneu)(spacing)) << 1) + 0x80000000u / (uint)count;
    lanei low = 0, high = triangleCount - 1;
    for (int step = 0; step < steps; ++step) {
        const lanei middle = (low + high) / 2;
        const mask beyond = as_laneu_(gatheri(shares, middle)) <= wanted;
        low = selecti_(low, min(middle + 1, high), beyond);
        high = selecti_(middle, high, beyond);
    }
    const lanei t = low;
    // Its number among the triangle's own.
    const laneu before = selectu_(as_laneu_(gatheri(shares, max(t - 1, (lanei)(0)))), (laneu)(0u), t == 0);
    const laneu j = i - mul_hi(before, (laneu)((uint)count));
    // A parallelogram's point, folded over its diagonal: as even as on the square.
    const real p = unit_of(j * LW_STEP_S + 0x80000000u), q = unit_of(j * LW_STEP_T + 0x80000000u);
    const mask folded = p + q > 1.0f;
    const real s = select_(p, 1.0f - p, folded), r = select_(q, 1.0f - q, folded);
    const lw_direction a = corner_of(triangles, triangleStride, LW_TRIANGLE_A, t);
    const lw_direction u = minus_(corner_of(triangles, triangleStride, LW_TRIANGLE_B, t), a);
    const lw_direction v = minus_(corner_of(triangles, triangleStride, LW_TRIANGLE_C, t), a);
    lw_direction normal = cross_(u, v);
    // So that no square leaves float's range, in whatever unit of length.
    const real largest = 1.0f / fmax(fmax(fabs(normal.x), fabs(normal.y)), fmax(fabs(normal.z), FLT_MIN));
    normal.x = normal.x * largest;
    normal.y = normal.y * largest;
    normal.z = normal.z * largest;
    const real length2 = dot_(normal, normal);
    const mask valid = and_(index < count, length2 > 0.25f);
    const real scale = rsqrt(select_((real)(1.0f), length2, valid));
    const lw_direction rgb = corner_of(triangles, triangleStride, LW_TRIANGLE_ALBEDO, t);
    store(a.x + u.x * s + v.x * r, surfels, first);
    store(a.y + u.y * s + v.y * r, surfels, first + stride);
    store(a.z + u.z * s + v.z * r, surfels, first + 2 * stride);
    store(normal.x * scale, surfels, first + 3 * stride);
    store(normal.y * scale, surfels, first + 4 * stride);
    store(normal.z * scale, surfels, first + 5 * stride);
    store(select_((real)(0.0f), (real)(radius), valid), surfels, first + LW_SURFEL_RADIUS * stride);
    store(as_real_(pack_albedo(rgb.x, rgb.y, rgb.z)), surfels, first + LW_SURFEL_ALBEDO * stride);
}
