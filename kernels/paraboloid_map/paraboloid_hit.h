// Where rays of a paraboloid map meet triangles. A triangle's image has curved edges, but a ray through a texel's centre
// is on one side or the other of the plane through the origin and an edge: three triple products decide, as in ray
// casting, and no edge is ever approximated by a chord.
//
// Watertight: the plane of an edge is (vi + vj) x (vj - vi), which changes its sign exactly when vi and vj change
// places, so the two triangles of an edge disagree about every ray but those exactly on it, which both take. (The
// sum and the difference instead of vi x vj: far triangles that are small would lose their edges in rounding.)
// Nothing here may be contracted or reassociated.
#ifndef LW_PARABOLOID_HIT_H
#define LW_PARABOLOID_HIT_H

#include "shared/geometry_types.h"
#include "shared/paraboloid_box.h"

// ---- triangles seen from a map's origin, one a lane

typedef struct {
    lw_direction a, b, c;  // from the origin, axes of the world
} lw_corners;

// Of triangles `t`, `t + 1`, ...
LW_FN lw_direction load_corner(__global const float* triangles, int stride, int t, int plane, float4 origin) {
    __global const float* p = triangles + plane * stride;
    const lw_direction v = {load(p, t) - origin.x, load(p, t + stride) - origin.y, load(p, t + 2 * stride) - origin.z};
    return v;
}
LW_FN lw_corners load_corners(__global const float* triangles, int stride, int t, float4 origin) {
    const lw_corners corners = {load_corner(triangles, stride, t, LW_TRIANGLE_A, origin),
                                load_corner(triangles, stride, t, LW_TRIANGLE_B, origin),
                                load_corner(triangles, stride, t, LW_TRIANGLE_C, origin)};
    return corners;
}

typedef struct {
    lw_direction ab, bc, ca;  // normals of the planes through the origin and an edge
    lw_direction normal;      // of the triangle, not unit
    real offset;              // normal.x = offset on its plane
} lw_planes;

LW_FN lw_planes planes_of(lw_corners t) {
    lw_planes p;
    p.ab = cross_(plus_(t.a, t.b), minus_(t.b, t.a));
    p.bc = cross_(plus_(t.b, t.c), minus_(t.c, t.b));
    p.ca = cross_(plus_(t.c, t.a), minus_(t.a, t.c));
    p.normal = cross_(minus_(t.b, t.a), minus_(t.c, t.a));
    p.offset = dot_(p.normal, t.a);
    return p;
}

// Planes of a group's triangles in memory, so that each can be held against the rays of all lanes.
typedef struct {
    float plane[13][LW_TRIANGLE_GROUP];
} lw_group_planes;

LW_FN void store_direction(lw_direction v, lw_group_planes* g, int plane, int first) {
    store(v.x, g->plane[plane], first);
    store(v.y, g->plane[plane + 1], first);
    store(v.z, g->plane[plane + 2], first);
}
LW_FN void store_planes(lw_planes p, lw_group_planes* g, int first) {
    store_direction(p.ab, g, 0, first);
    store_direction(p.bc, g, 3, first);
    store_direction(p.ca, g, 6, first);
    store_direction(p.normal, g, 9, first);
    store(p.offset, g->plane[12], first);
}
LW_FN lw_direction splat_direction(const lw_group_planes* g, int plane, int t) {
    const lw_direction v = {(real)(g->plane[plane][t]), (real)(g->plane[plane + 1][t]), (real)(g->plane[plane + 2][t])};
    return v;
}

// ---- rays

// The ray of a texel, in the axes of the world; its length is 1 + u^2 + v^2.
LW_FN lw_direction world_ray(lw_paraboloid frame, real u, real v) {
    const lw_direction w = paraboloid_ray(u, v);
    const lw_direction ray = {w.x * frame.axisX.x + w.y * frame.axisY.x + w.z * frame.axisZ.x,
                              w.x * frame.axisX.y + w.y * frame.axisY.y + w.z * frame.axisZ.y,
                              w.x * frame.axisX.z + w.y * frame.axisY.z + w.z * frame.axisZ.z};
    return ray;
}

// Rays on or within the edges of triangle `t` of the group. Either side counts.
LW_FN mask within_edges(const lw_group_planes* g, int t, lw_direction ray) {
    const real ab = dot_(splat_direction(g, 0, t), ray), bc = dot_(splat_direction(g, 3, t), ray),
               ca = dot_(splat_direction(g, 6, t), ray);
    return or_(and_(and_(ab >= 0.0f, bc >= 0.0f), ca >= 0.0f), and_(and_(ab <= 0.0f, bc <= 0.0f), ca <= 0.0f));
}

// Along rays of this length; not above 0 before the origin; infinite or no number edge-on.
LW_FN real plane_distance(const lw_group_planes* g, int t, lw_direction ray, real length) {
    return (real)(g->plane[12][t]) / dot_(splat_direction(g, 9, t), ray) * length;
}

#endif
