// Paraboloid maps of clusters of VPLs (Heidrich & Seidel 1998; imperfect shadow maps, Ritschel et al. 2008; one map
// for a cluster, Dong et al. 2009): where each map stands, its empty records, and what the triangles that the sweeps
// of paraboloid_draw.cl left in them come to. Formats: shared/paraboloid_types.h.
#include "paraboloid_raster.h"
#include "shared/cluster_types.h"
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

// The second words of `LW_WIDTH` records from the first on.
LW_FN void store_second(laneu second, real first, __global uint* records) {
    const real o = as_real_(second);
    store(zip_lo_(first, o), (__global float*)records, 0);
    store(zip_hi_(first, o), (__global float*)records, LW_WIDTH);
}

LW_FN lw_direction gather3(__global const float* triangles, int stride, int plane, lanei t) {
    const lw_direction v = {gather(triangles + plane * stride, t), gather(triangles + (plane + 1) * stride, t),
                            gather(triangles + (plane + 2) * stride, t)};
    return v;
}

// One work-item = LW_WIDTH texels (x) of a map (y): the nearest triangle becomes its normal, turned to the
// origin, and its albedo. `texels` of a map: a multiple of 16.
__kernel void paraboloid_map_resolve(__global const float* triangles, int stride,
                                     __global const lw_paraboloid* frames, __global const int* states, int size,
                                     int hasTriangles, __global uint* records, __global uint* albedo) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1);
    if (texel >= size * size || !(states[map] & LW_MAP_STALE)) return;
    const int at = map * size * size + texel;
    __global const float* words = (__global const float*)(records + 2 * at);
    const real low = load(words, 0), high = load(words, LW_WIDTH);
    const lanei id = as_lanei_(odd_(low, high));
    const real distance = even_(low, high);
    const mask hit = id >= 0;
    laneu bits = 0, colour = 0;
    if (hasTriangles && any_(hit)) {
        const lw_paraboloid frame = frames[map];
        const lanei t = selecti_((lanei)(0), id, hit);
        const lw_direction a = gather3(triangles, stride, LW_TRIANGLE_A, t);
        lw_direction normal = cross_(minus_(gather3(triangles, stride, LW_TRIANGLE_B, t), a),
                                     minus_(gather3(triangles, stride, LW_TRIANGLE_C, t), a));
        // So that no square leaves float's range, in whatever unit of length.
        const real largest = 1.0f / fmax(fmax(fabs(normal.x), fabs(normal.y)), fmax(fabs(normal.z), FLT_MIN));
        normal.x = normal.x * largest;
        normal.y = normal.y * largest;
        normal.z = normal.z * largest;
        const float step = paraboloid_step(size);
        const real x = to_real(lanei_iota() + texel % size), y = (real)((float)(texel / size));
        // Against the ray that met it.
        const lw_direction ray = world_ray(frame, paraboloid_uv(x, step), paraboloid_uv(y, step));
        const real length = rsqrt(dot_(normal, normal));
        const real scale = select_(length, -length, dot_(normal, ray) > 0.0f);
        const lw_direction n = to_frame(frame, normal);
        bits = selectu_(bits, pack_normal(n.x * scale, n.y * scale, n.z * scale), hit);
        const lw_direction rgb = gather3(triangles, stride, LW_TRIANGLE_ALBEDO, t);
        colour = selectu_(colour, pack_albedo(rgb.x, rgb.y, rgb.z), hit);
    }
    store_second(bits, distance, records + 2 * at);
    store(colour, albedo, at);
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
    const mask hit = bits != 0;
    const lw_paraboloid f = frames[map];
    const real x = packed_normal(bits, 0), y = packed_normal(bits, 1), z = packed_normal(bits, 2);
    const real zero = 0.0f;
    store(select_(zero, even_(low, high), hit), planes, at);
    store(select_(zero, x * f.axisX.x + y * f.axisY.x + z * f.axisZ.x, hit), planes, at + stride);
    store(select_(zero, x * f.axisX.y + y * f.axisY.y + z * f.axisZ.y, hit), planes, at + 2 * stride);
    store(select_(zero, x * f.axisX.z + y * f.axisY.z + z * f.axisZ.z, hit), planes, at + 3 * stride);
    for (int c = 0; c < 3; ++c) store(packed_albedo(colour, c), planes, at + (4 + c) * stride);
}
