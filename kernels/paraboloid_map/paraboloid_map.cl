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

// What a texel's neighbour met makes the texel doubtful where it is nearer than what the texel met by this share of the ray's length,
// and stands before the plane of that by this share. Nearer, raised: light passes again along the rims of openings; lowered: corners
// between walls and curved things darken. Before, raised: the same rims; lowered: mouldings and folds darken each other.
// Measured in docs/techniques/ssvp_visibility.md.
#define LW_DOUBT_NEARER 2e-2f
#define LW_DOUBT_BEFORE 1e-2f

// What texels of a map met, in the map's frame: how far off, and where (anywhere, if at infinity).
typedef struct {
    real distance, x, y, z;
} lw_met;

LW_FN lw_met met_at(real distance, lanei x, int y, float step) {
    const lw_direction d = paraboloid_direction(paraboloid_uv(to_real(x), step), paraboloid_uv((real)(float)y, step));
    const real length = select_((real)0.0f, distance, distance < INFINITY);
    const lw_met met = {distance, d.x * length, d.y * length, d.z * length};
    return met;
}

// Distances of LW_WIDTH texels from record `at` on.
LW_FN real distances_from(__global const float* records, int at) {
    return even_(load_whole(records + 2 * at), load_whole(records + 2 * at + LW_WIDTH));
}

// Whether what a neighbour met clearly stands before what a texel met, a surface of normal (nx, ny, nz): nearer, and before its plane.
// Where the texel met nothing there is no plane to stand before.
LW_FN mask stands_before(lw_met neighbour, lw_met own, real nx, real ny, real nz) {
    const real height = fma_(nx, neighbour.x - own.x, fma_(ny, neighbour.y - own.y, nz * (neighbour.z - own.z)));
    const mask nearer = neighbour.distance < own.distance * (1.0f - LW_DOUBT_NEARER);
    return and_(nearer, or_(height > LW_DOUBT_BEFORE * own.distance, own.distance >= INFINITY));
}

// One work-item = LW_WIDTH texels (x) of a map (y): LW_PARABOLOID_DOUBTFUL of stale maps. Of neighbours distances are used; normals,
// whose signs are written, by their own items alone.
__kernel void paraboloid_map_marks(__global const int* states, int size, __global float* records) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1);
    if (texel >= size * size || !(states[map] & LW_MAP_STALE)) return;
    const int at = map * size * size + texel, column = texel % size, y = texel / size;
    const float step = paraboloid_step(size);
    const lanei x = lanei_iota() + column;
    const real low = load_whole(records + 2 * at), high = load_whole(records + 2 * at + LW_WIDTH), distance = even_(low, high);
    const lanei bits = as_lanei_(odd_(low, high));
    const real nx = packed_normal(bits, 0), ny = packed_normal(bits, 1), nz = packed_normal(bits, 2);
    const lw_met own = met_at(distance, x, y, step);
    // Beyond the map's border a texel is its own neighbour, which stands before nothing.
    const real left = column ? distances_from(records, at - 1) : from_left_(distance);
    const real right = column + LW_WIDTH < size ? distances_from(records, at + 1) : from_right_(distance);
    mask doubtful = or_(stands_before(met_at(left, max(x - 1, (lanei)0), y, step), own, nx, ny, nz),
                        stands_before(met_at(right, min(x + 1, (lanei)(size - 1)), y, step), own, nx, ny, nz));
    if (y > 0) doubtful = or_(doubtful, stands_before(met_at(distances_from(records, at - size), x, y - 1, step), own, nx, ny, nz));
    if (y + 1 < size) doubtful = or_(doubtful, stands_before(met_at(distances_from(records, at + size), x, y + 1, step), own, nx, ny, nz));
    if (!any_(doubtful)) return;
    const lanei mark = selecti_((lanei)0, (lanei)(int)LW_PARABOLOID_DOUBTFUL, doubtful);
    scatter(as_real_(bits | mark), records, (lanei_iota() + at) * 2 + 1);
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
