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
#include "shared/paraboloid.h"

LW_FN lw_direction plus_(lw_direction a, lw_direction b) {
    const lw_direction sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}
LW_FN lw_direction minus_(lw_direction a, lw_direction b) {
    const lw_direction difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}
LW_FN lw_direction cross_(lw_direction a, lw_direction b) {
    const lw_direction product = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return product;
}
LW_FN real dot_(lw_direction a, lw_direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LW_FN lw_direction to_frame(lw_paraboloid frame, lw_direction v) {
    const lw_direction turned = {along_axis(frame.axisX, v.x, v.y, v.z), along_axis(frame.axisY, v.x, v.y, v.z),
                                 along_axis(frame.axisZ, v.x, v.y, v.z)};
    return turned;
}

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

// ---- which texels can be covered

typedef struct {
    lanei x0, x1, y0, y1;  // inclusive
    mask any;              // some texel's centre at all
} lw_texel_box;

// For rounding, on the disc: a fiftieth of a texel of the largest map.
#define LW_BOX_MARGIN 1e-4f

LW_FN lw_texel_box box_of(real left, real right, real bottom, real top, int size, mask whole, mask none) {
    const float step = paraboloid_step(size), last = (float)(size - 1);
    // The disc's edge against the box's nearest point.
    const real nearX = fmax(fmax(left, -right), 0.0f), nearY = fmax(fmax(bottom, -top), 0.0f);
    const mask outside = nearX * nearX + nearY * nearY > LW_PARABOLOID_RIM * LW_PARABOLOID_RIM * 1.001f;
    lw_texel_box box;
    const real x0 = ceil(paraboloid_texel(left - LW_BOX_MARGIN, step));
    const real x1 = floor(paraboloid_texel(right + LW_BOX_MARGIN, step));
    const real y0 = ceil(paraboloid_texel(bottom - LW_BOX_MARGIN, step));
    const real y1 = floor(paraboloid_texel(top + LW_BOX_MARGIN, step));
    box.x0 = to_lanei(select_(fmin(fmax(x0, 0.0f), last + 1.0f), (real)(0.0f), whole));
    box.x1 = to_lanei(select_(fmin(fmax(x1, -1.0f), last), (real)(last), whole));
    box.y0 = to_lanei(select_(fmin(fmax(y0, 0.0f), last + 1.0f), (real)(0.0f), whole));
    box.y1 = to_lanei(select_(fmin(fmax(y1, -1.0f), last), (real)(last), whole));
    const mask some = and_(box.x0 <= box.x1, box.y0 <= box.y1);
    box.any = and_(not_(none), or_(whole, and_(some, not_(outside))));
    return box;
}

// The cap of directions around unit `axis` (the map's frame) with this cosine and sine of its half angle. A cap
// that does not hold the pole -z has a circle as its image; one near the pole may cover any texel.
LW_FN lw_texel_box box_of_cap(lw_direction axis, real cosine, real sine, int size) {
    const float rimSine = 0.96592583f;
    const mask beyond = and_(cosine > 0.26f, axis.z < LW_PARABOLOID_RIM_COSINE * cosine - rimSine * sine - LW_BOX_MARGIN);
    const mask round = and_(cosine > 0.05f, axis.z + cosine > 0.05f);
    const real scale = 1.0f / select_((real)(1.0f), axis.z + cosine, round);
    const real x = axis.x * scale, y = axis.y * scale, radius = sine * scale;
    return box_of(x - radius, x + radius, y - radius, y + radius, size, not_(round), beyond);
}

// Groups of triangles by their bounding spheres; radius below 0: an empty group.
LW_FN lw_texel_box box_of_spheres(lw_paraboloid frame, int size, real cx, real cy, real cz, real radius) {
    const lw_direction world = {cx - frame.origin.x, cy - frame.origin.y, cz - frame.origin.z};
    lw_direction axis = to_frame(frame, world);
    const real distance = sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
    const real inverse = 1.0f / fmax(distance, FLT_MIN);
    const real sine = fmin(radius * inverse * 1.0001f, 1.0f);
    axis.x = axis.x * inverse;
    axis.y = axis.y * inverse;
    axis.z = axis.z * inverse;
    lw_texel_box box = box_of_cap(axis, sqrt(fmax(1.0f - sine * sine, 0.0f)), sine, size);
    box.any = and_(box.any, radius >= 0.0f);
    return box;
}

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
