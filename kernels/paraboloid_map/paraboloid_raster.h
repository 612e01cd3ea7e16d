// Exact triangles on a paraboloid map. A triangle's image has curved edges, but a ray through a texel's centre
// is on one side or the other of the plane through the origin and an edge: three triple products decide, as in ray
// casting, and no edge is ever approximated by a chord.
//
// Watertight: the plane of an edge is (vi + vj) x (vj - vi), which changes its sign exactly when vi and vj change
// places, so the two triangles of an edge disagree about every ray but those exactly on it, which both take. (The
// sum and the difference instead of vi x vj: far triangles that are small would lose their edges in rounding.)
// Nothing here may be contracted or reassociated, nor differ between the two ways of drawing.
#ifndef LW_PARABOLOID_RASTER_H
#define LW_PARABOLOID_RASTER_H

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
// Of one triangle, the same in every lane.
LW_FN lw_direction splat_corner(__global const float* triangles, int stride, int t, int plane, float4 origin) {
    __global const float* p = triangles + plane * stride + t;
    const lw_direction v = {(real)(p[0]) - origin.x, (real)(p[stride]) - origin.y, (real)(p[2 * stride]) - origin.z};
    return v;
}
LW_FN lw_corners splat_corners(__global const float* triangles, int stride, int t, float4 origin) {
    const lw_corners corners = {splat_corner(triangles, stride, t, LW_TRIANGLE_A, origin),
                                splat_corner(triangles, stride, t, LW_TRIANGLE_B, origin),
                                splat_corner(triangles, stride, t, LW_TRIANGLE_C, origin)};
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

// The ray of a texel, in the axes of the world; its length is 1 + u^2 + v^2.
LW_FN lw_direction world_ray(lw_paraboloid frame, real u, real v) {
    const lw_direction w = paraboloid_ray(u, v);
    const lw_direction ray = {w.x * frame.axisX.x + w.y * frame.axisY.x + w.z * frame.axisZ.x,
                              w.x * frame.axisX.y + w.y * frame.axisY.y + w.z * frame.axisZ.y,
                              w.x * frame.axisX.z + w.y * frame.axisY.z + w.z * frame.axisZ.z};
    return ray;
}

// Where the rays of texels (x, y) meet triangles: the distance, 0 for those that miss. Either side counts.
LW_FN real hit_distance(lw_paraboloid frame, float step, lw_planes t, lanei x, lanei y) {
    const real u = paraboloid_uv(to_real(x), step), v = paraboloid_uv(to_real(y), step);
    const lw_direction ray = world_ray(frame, u, v);
    const real ab = dot_(t.ab, ray), bc = dot_(t.bc, ray), ca = dot_(t.ca, ray);
    const mask within = or_(fmin(fmin(ab, bc), ca) >= 0.0f, fmax(fmax(ab, bc), ca) <= 0.0f);
    const real r2 = u * u + v * v;
    const real distance = t.offset / dot_(t.normal, ray) * (1.0f + r2);
    // Before the origin, not edge-on (infinite, or no number), and before the rim.
    const mask met = and_(and_(distance > 0.0f, distance < INFINITY), r2 <= LW_PARABOLOID_RIM * LW_PARABOLOID_RIM);
    return select_((real)(0.0f), distance, and_(within, met));
}

// ---- which texels a triangle can cover

// Triangles that span a good part of the map or come near its pole: the cap around their corners.
LW_FN lw_texel_box box_of_corners_cap(lw_direction a, lw_direction b, lw_direction c, int size) {
    const real la = rsqrt(dot_(a, a)), lb = rsqrt(dot_(b, b)), lc = rsqrt(dot_(c, c));
    const lw_direction ua = {a.x * la, a.y * la, a.z * la}, ub = {b.x * lb, b.y * lb, b.z * lb},
                       uc = {c.x * lc, c.y * lc, c.z * lc};
    lw_direction axis = plus_(plus_(ua, ub), uc);
    const real l = rsqrt(dot_(axis, axis));
    axis.x = axis.x * l;
    axis.y = axis.y * l;
    axis.z = axis.z * l;
    // A corner at the origin leaves no number, and with it the whole map.
    const real cosine = fmin(fmin(dot_(axis, ua), dot_(axis, ub)), dot_(axis, uc)) - LW_BOX_MARGIN * 0.01f;
    return box_of_cap(axis, cosine, sqrt(fmax(1.0f - cosine * cosine, 0.0f)), size);
}

// Great circles are circles on the disc, of radius 1 or more: an arc between points a distance L <= 1/2 apart
// leaves its chord by less than L^2 / 7.
LW_FN lw_texel_box box_of_corners(lw_paraboloid frame, int size, lw_corners world) {
    const lw_direction a = to_frame(frame, world.a), b = to_frame(frame, world.b), c = to_frame(frame, world.c);
    const real la = sqrt(dot_(a, a)), lb = sqrt(dot_(b, b)), lc = sqrt(dot_(c, c));
    const real da = la + a.z, db = lb + b.z, dc = lc + c.z;
    const real ia = 1.0f / da, ib = 1.0f / db, ic = 1.0f / dc;
    const real left = fmin(fmin(a.x * ia, b.x * ib), c.x * ic), right = fmax(fmax(a.x * ia, b.x * ib), c.x * ic);
    const real bottom = fmin(fmin(a.y * ia, b.y * ib), c.y * ic), top = fmax(fmax(a.y * ia, b.y * ib), c.y * ic);
    const real length2 = sq(right - left) + sq(top - bottom), bulge = length2 * (1.0f / 7.0f);
    const mask offPole = and_(and_(da > 1e-3f * la, db > 1e-3f * lb), dc > 1e-3f * lc);
    const mask compact = and_(offPole, length2 <= 0.25f);
    lw_texel_box box = box_of(left - bulge, right + bulge, bottom - bulge, top + bulge, size, splat_mask(0), splat_mask(0));
    if (all_(compact)) return box;
    const lw_texel_box cap = box_of_corners_cap(a, b, c, size);
    box.x0 = selecti_(cap.x0, box.x0, compact);
    box.x1 = selecti_(cap.x1, box.x1, compact);
    box.y0 = selecti_(cap.y0, box.y0, compact);
    box.y1 = selecti_(cap.y1, box.y1, compact);
    box.any = or_(and_(box.any, compact), and_(cap.any, not_(compact)));
    return box;
}

// ---- tiles that a triangle can cover

#define LW_TILE 16  // texels a side

// The most that 2 a x - c x^2 is on [x0, x1].
LW_FN real most_of_parabola(real a, real c, real x0, real x1) {
    const real top = fmin(fmax(a / select_((real)(1.0f), c, c > 0.0f), x0), x1);
    const real ends = fmax((2.0f * a - c * x0) * x0, (2.0f * a - c * x1) * x1);
    return fmax(ends, (2.0f * a - c * top) * top);
}

// Lanes whose tile (x, y) has a ray on the inner side of the plane with this normal, times `side`. On the disc the
// triple product is C + (2 A u - C u^2) + (2 B v - C v^2): its maximum over a tile is exact.
LW_FN mask tile_inside(lw_paraboloid frame, lw_direction normal, real side, real u0, real u1, real v0, real v1) {
    const lw_direction n = to_frame(frame, normal);
    const real a = n.x * side, b = n.y * side, c = n.z * side;
    const real rounding = 1e-5f * (fabs(a) + fabs(b) + fabs(c));
    return c + most_of_parabola(a, c, u0, u1) + most_of_parabola(b, c, v0, v1) >= -rounding;
}

LW_FN mask tiles_touched(lw_paraboloid frame, float step, lw_planes t, lanei tileX, int tileY) {
    const real u0 = paraboloid_uv(to_real(tileX * LW_TILE), step), u1 = u0 + (LW_TILE - 1) * step;
    const real v0 = paraboloid_uv((real)((float)(tileY * LW_TILE)), step), v1 = v0 + (LW_TILE - 1) * step;
    // A ray that meets the triangle before the origin has the origin's side of its plane on that of every edge's.
    const real side = select_((real)(-1.0f), (real)(1.0f), t.offset > 0.0f);
    const mask edges = and_(and_(tile_inside(frame, t.ab, side, u0, u1, v0, v1),
                                 tile_inside(frame, t.bc, side, u0, u1, v0, v1)),
                            tile_inside(frame, t.ca, side, u0, u1, v0, v1));
    return edges;
}

#endif
