// The functions of shared/paraboloid.h, a receiver or a direction per lane.
#include "shared/paraboloid.h"

// Unit directions of texels (x, y), and back.
__kernel void lookup_round_trip(__global const float* x, __global const float* y, int size, __global float* planes,
                                int stride) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    const float step = paraboloid_step(size);
    const lw_direction d = paraboloid_direction(paraboloid_uv(load(x, i), step), paraboloid_uv(load(y, i), step));
    store(d.x, planes, i);
    store(d.y, planes, i + stride);
    store(d.z, planes, i + 2 * stride);
    lw_paraboloid map;
    map.origin = (float4)(0.0f);
    map.axisX = (float4)(1.0f, 0.0f, 0.0f, 0.0f);
    map.axisY = (float4)(0.0f, 1.0f, 0.0f, 0.0f);
    map.axisZ = (float4)(0.0f, 0.0f, 1.0f, 0.0f);
    const lw_map_receiver r = paraboloid_receiver(map, size, 3.0f * d.x, 3.0f * d.y, 3.0f * d.z, d.x, d.y, d.z);
    store(r.x, planes, i + 3 * stride);
    store(r.y, planes, i + 4 * stride);
    store(ones_(r.inside), planes, i + 5 * stride);
    const laneu bits = pack_normal(d.x, d.y, d.z);
    const lanei normal = as_lanei_(as_real_(bits));
    store(packed_normal(normal, 0), planes, i + 6 * stride);
    store(packed_normal(normal, 1), planes, i + 7 * stride);
    store(packed_normal(normal, 2), planes, i + 8 * stride);
}

// Receivers: planes position xyz, normal xyz. Out: hard, soft, strict.
__kernel void lookup_receivers(__global const lw_paraboloid* frames, __global const float* records, int size, int map,
                               __global const float* receivers, int stride, __global float* out) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    if (i >= stride) return;
    const lw_map_receiver r = paraboloid_receiver(
        frames[map], size, load(receivers, i), load(receivers, i + stride), load(receivers, i + 2 * stride),
        load(receivers, i + 3 * stride), load(receivers, i + 4 * stride), load(receivers, i + 5 * stride));
    store(ones_(paraboloid_sees(records, map * size * size, size, r)), out, i);
    store(paraboloid_visibility(records, map * size * size, size, r), out, i + stride);
    mask doubtful;
    const mask seen = paraboloid_sees_strictly(records, map * size * size, size, r, &doubtful);
    store(ones_(seen) - ones_(doubtful), out, i + 2 * stride);
}
