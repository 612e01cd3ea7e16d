// Paraboloid maps of clusters of VPLs (Heidrich & Seidel 1998; imperfect shadow maps, Ritschel et al. 2008; one map
// for a cluster, Dong et al. 2009): where each map stands, and its empty records. What triangles leave in them:
// paraboloid_trace.cl. Formats: shared/paraboloid_types.h.
#include "shared/cluster_types.h"
#include "shared/paraboloid.h"
#include "shared/paraboloid_map_types.h"

LW_FN int differs(float4 a, float4 b) { return any(as_int4(a) != as_int4(b)); }

// One work-item = one map. A map's place decides all that is drawn into it, so one that stands where
// it was drawn last is not stale. `diagonal`: of the geometry, m. `force`: every map is stale.
__kernel void paraboloid_map_place(__global const lw_cluster* clusters, int mapCount, __global const float* diagonal,
                                   int force, __global lw_paraboloid* frames, __global int* states,
                                   volatile __global uint* counters) {
    const int map = (int)get_global_id(0);
    if (map >= mapCount) return;
    const lw_cluster cluster = clusters[map];
    const float4 zero = (float4)(0.0f);
    lw_paraboloid frame = {zero, zero, zero, zero};
    // The normals of two opposite walls sum up to none; the medoid has one.
    float4 z = cluster.normal;
    z.w = 0.0f;
    if (!(dot(z, z) > 0.25f)) z = cluster.medoidNormal;
    z.w = 0.0f;
    const int drawn = cluster.position.w > 0.0f && dot(z, z) > 0.25f;
    if (drawn) {
        z = z * rsqrt(dot(z, z));
        const float lift = LW_PARABOLOID_LIFT * diagonal[0];
        frame.origin = cluster.medoidPosition + lift * cluster.medoidNormal;
        frame.origin.w = 1.0f;
        frame.axisZ = z;
        paraboloid_axes(z, &frame.axisX, &frame.axisY);
        frame.axisX.w = lift;
    }
    const lw_paraboloid last = frames[map];
    const int stale = force || differs(frame.origin, last.origin) || differs(frame.axisZ, last.axisZ);
    states[map] = stale ? LW_MAP_STALE | (drawn ? LW_MAP_DRAWN : 0) : 0;
    if (!stale) return;
    frames[map] = frame;
    atomic_inc(counters + LW_MAP_REDRAWN);
}

// One work-item = one texel (x) of a map (y): infinitely far, no triangle.
__kernel void paraboloid_map_clear(__global const int* states, int texels, __global uint* records) {
    const int texel = (int)get_global_id(0), map = (int)get_global_id(1);
    if (texel >= texels || !(states[map] & LW_MAP_STALE)) return;
    vstore2((uint2)(as_uint(INFINITY), 0xffffffffu), (size_t)map * texels + texel, records);
}

// One work-item = LW_WIDTH texels (x) of a map (y): marks those of stale maps beside which another met something nearer. Distances
// are read and normals written: no item reads what another writes.
__kernel void paraboloid_map_marks(__global const int* states, int size, __global float* records) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1);
    if (texel >= size * size || !(states[map] & LW_MAP_STALE)) return;
    const lanei x = lanei_iota() + texel % size, last = (lanei)(size - 1);
    const int y = texel / size, first = map * size * size;
    const lanei at = paraboloid_record(first, size, x, (lanei)y);
    real nearest = gather(records, at);
    const real limit = nearest * (1.0f - 0.5f * LW_PARABOLOID_NEARER);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const lanei column = clamp(x + dx, (lanei)0, last);
            nearest = fmin(nearest, gather(records, paraboloid_record(first, size, column, (lanei)clamp(y + dy, 0, size - 1))));
        }
    const lanei mark = selecti_((lanei)0, (lanei)(int)LW_PARABOLOID_BESIDE_NEARER, nearest < limit);
    scatter(as_real_(as_lanei_(gather(records, at + 1)) | mark), records, at + 1);
}

// One work-item = LW_WIDTH texels (x) of a map (y): distance, normal in the world, albedo as planes for a debug
// view, the maps one below the other; 0 where nothing was met.
__kernel void paraboloid_map_planes(__global const lw_paraboloid* frames, __global const float* records,
                                    __global const int* albedo, int size, __global float* planes, int stride) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1);
    if (texel >= size * size) return;
    const int at = map * size * size + texel;
    const real low = load(records, 2 * at), high = load(records, 2 * at + LW_WIDTH);
    const lanei bits = as_lanei_(odd_(low, high)), colour = loadi(albedo, at);
    const mask hit = (bits & (lanei)LW_PARABOLOID_HIT) != 0;
    const lw_paraboloid f = frames[map];
    const real x = packed_normal(bits, 0), y = packed_normal(bits, 1), z = packed_normal(bits, 2);
    const real zero = 0.0f;
    store(select_(zero, even_(low, high), hit), planes, at);
    store(select_(zero, x * f.axisX.x + y * f.axisY.x + z * f.axisZ.x, hit), planes, at + stride);
    store(select_(zero, x * f.axisX.y + y * f.axisY.y + z * f.axisZ.y, hit), planes, at + 2 * stride);
    store(select_(zero, x * f.axisX.z + y * f.axisY.z + z * f.axisZ.z, hit), planes, at + 3 * stride);
    for (int c = 0; c < 3; ++c) store(packed_albedo(colour, c), planes, at + (4 + c) * stride);
}
