// Paraboloid maps on lanes: directions to texels and back (Heidrich & Seidel 1998), and what a receiver asks of a
// cluster's map: whether its light arrives (as imperfect shadow maps do, Ritschel et al. 2008; one map for a
// cluster of VPLs, Dong et al. 2009). The paraboloid's parallel projection is the stereographic one,
// (u, v) = d.xy / (1 + d.z), whose disc reaches here beyond the unit circle of the hemisphere.
//
// A depth test needs a bias against a surface's shadow upon itself that grows with the texel and the slope, and is
// then as thick as a wall. The test here asks instead whether the receiver lies in the tangent plane of
// what the texel saw: a plane has no slope, and both limits can be tight.
#ifndef LW_PARABOLOID_H
#define LW_PARABOLOID_H

#include "paraboloid_types.h"
#include "wide.h"

// Share of the ray's length within which a receiver counts as the surface that the texel saw, along the ray and
// off its plane. Raised, thin walls leak; lowered, normals of 10 bits and curved surfaces give acne.
#define LW_PARABOLOID_BIAS 2e-3f
// Cosine between the receiver's normal and the stored one above which it can be the same surface; lax, as
// normals of a G-buffer are bent by normal maps. At 0 the wall behind an edge would count as the one before it.
#define LW_PARABOLOID_AGREES 0.5f

// ---- texels and directions

// Distance of neighbouring texel centres on the disc.
LW_FN float paraboloid_step(int size) { return 2.0f * LW_PARABOLOID_RIM / (float)size; }
// Coordinate on the disc of texel column or row x, and the inverse: its whole numbers are texel centres.
LW_FN real paraboloid_uv(real x, float step) { return (x + 0.5f) * step - LW_PARABOLOID_RIM; }
LW_FN real paraboloid_texel(real uv, float step) { return (uv + LW_PARABOLOID_RIM) / step - 0.5f; }

typedef struct {
    real x, y, z;
} lw_direction;

// Along (u, v) in the map's frame, of length 1 + u^2 + v^2: tests against planes need no unit length.
LW_FN lw_direction paraboloid_ray(real u, real v) {
    const lw_direction ray = {2.0f * u, 2.0f * v, 1.0f - u * u - v * v};
    return ray;
}
LW_FN lw_direction paraboloid_direction(real u, real v) {
    const real scale = 1.0f / (1.0f + u * u + v * v);
    lw_direction d = paraboloid_ray(u, v);
    d.x = d.x * scale;
    d.y = d.y * scale;
    d.z = d.z * scale;
    return d;
}

// Frame around a unit z without a branch, one frame for one z (Duff et al. 2017).
LW_FN void paraboloid_axes(float4 z, float4* axisX, float4* axisY) {
    const float s = copysign(1.0f, z.z), a = -1.0f / (s + z.z), b = z.x * z.y * a;
    *axisX = (float4)(1.0f + s * z.x * z.x * a, s * b, -s * z.x, 0.0f);
    *axisY = (float4)(b, s + z.y * z.y * a, -z.y, 0.0f);
}

// ---- records

LW_FN laneu pack_normal(real x, real y, real z) {
    const laneu px = to_laneu(x * 511.0f + 512.5f), py = to_laneu(y * 511.0f + 512.5f),
                pz = to_laneu(z * 511.0f + 512.5f);
    return px | (py << 10) | (pz << 20) | LW_PARABOLOID_HIT;
}
// Component 0, 1 or 2, within 1/1022.
LW_FN real packed_normal(lanei bits, int component) {
    return fma_(to_real(bits & (1023 << (10 * component))), 1.0f / (float)(1 << (10 * component)), -512.0f) * (1.0f / 511.0f);
}
// Albedo in [0,1], 10 bits a channel from the lowest; and back.
LW_FN laneu pack_albedo(real r, real g, real b) {
    const real most = 1023.0f;
    return to_laneu(fmin(r * 1023.0f + 0.5f, most)) | (to_laneu(fmin(g * 1023.0f + 0.5f, most)) << 10) |
           (to_laneu(fmin(b * 1023.0f + 0.5f, most)) << 20);
}
LW_FN real packed_albedo(lanei bits, int channel) {
    return to_real((bits >> (10 * channel)) & 1023) * (1.0f / 1023.0f);
}

// ---- receivers

// A receiver as one map sees it: prepared once, then looked up in as many texels as wanted.
typedef struct {
    real qx, qy, qz;  // from the origin, in the map's frame
    real nx, ny, nz;  // its normal there
    real distance;    // |q|
    real x, y;        // in texels; whole numbers are texel centres
    mask inside;      // before the rim, and not on the back of the surface that the origin stands on
} lw_map_receiver;

LW_FN real along_axis(float4 axis, real x, real y, real z) {
    return fma_(axis.x, x, fma_(axis.y, y, axis.z * z));
}

LW_FN lw_map_receiver paraboloid_receiver(lw_paraboloid map, int size, real px, real py, real pz, real nx,
                                          real ny, real nz) {
    lw_map_receiver r;
    const real wx = px - map.origin.x, wy = py - map.origin.y, wz = pz - map.origin.z;
    r.qx = along_axis(map.axisX, wx, wy, wz);
    r.qy = along_axis(map.axisY, wx, wy, wz);
    r.qz = along_axis(map.axisZ, wx, wy, wz);
    r.nx = along_axis(map.axisX, nx, ny, nz);
    r.ny = along_axis(map.axisY, nx, ny, nz);
    r.nz = along_axis(map.axisZ, nx, ny, nz);
    r.distance = sqrt(fma_(r.qx, r.qx, fma_(r.qy, r.qy, r.qz * r.qz)));
    // Behind its plane by next to nothing, the origin stands on the other side of the receiver's own sheet, a ceiling of no
    // thickness: there the horizon runs through the texel, which saw the sky.
    // Farther behind, normal maps and smooth normals on coarse facets are the usual case, and the texel is asked.
    const real behind = fma_(r.qx, r.nx, fma_(r.qy, r.ny, r.qz * r.nz));  // the receiver's plane
    const mask faces = or_(behind <= 0.0f, and_(behind > LW_PARABOLOID_BIAS * r.distance, behind > 2.0f * map.axisX.w));
    // Strict: also false at the origin, where there is no direction, and for what is not a number.
    r.inside = and_(r.qz > LW_PARABOLOID_RIM_COSINE * r.distance, faces);
    const real denominator = select_((real)(1.0f), (r.distance + r.qz) * paraboloid_step(size), r.inside);
    const real scale = 1.0f / denominator, centre = 0.5f * (float)size - 0.5f;
    // Outside: the map's middle, so that every index is one.
    r.x = select_(centre, fma_(r.qx, scale, centre), r.inside);
    r.y = select_(centre, fma_(r.qy, scale, centre), r.inside);
    return r;
}

LW_FN lanei paraboloid_record(int firstRecord, int size, lanei x, lanei y) { return 2 * (firstRecord + y * size + x); }

// How far the receiver lies off the plane of a texel's hit, and how far their normals agree (a cosine).
// Plane of the hit: n.(p - h w/m) = 0 with the texel's ray w of length m = 1 + r2; multiplied by m, it takes no division.
LW_FN void compare_planes(real hit, lanei bits, real u, real v, real r2, lw_map_receiver r, real* off, real* agreement) {
    const real nx = packed_normal(bits, 0), ny = packed_normal(bits, 1), nz = packed_normal(bits, 2);
    const real receiverSide = fma_(nx, r.qx, fma_(ny, r.qy, nz * r.qz)) * (1.0f + r2);
    const real hitSide = hit * fma_(2.0f * u, nx, fma_(2.0f * v, ny, (1.0f - r2) * nz));
    *off = fabs(receiverSide - hitSide);
    *agreement = fma_(nx, r.nx, fma_(ny, r.ny, nz * r.nz));
}

// Whether the surface that texel (x, y) saw, of record (hit, bits), leaves the receiver lit.
LW_FN mask record_lit(real hit, lanei bits, int size, lanei x, lanei y, lw_map_receiver r) {
    const float step = paraboloid_step(size);
    const real u = paraboloid_uv(to_real(x), step), v = paraboloid_uv(to_real(y), step);
    const real r2 = fma_(u, u, v * v), limit = LW_PARABOLOID_BIAS * r.distance * (1.0f + r2);
    real off, agreement;
    compare_planes(hit, bits, u, v, r2, r, &off, &agreement);
    const mask before = r.distance <= hit * (1.0f + LW_PARABOLOID_BIAS);
    const mask own = and_(off <= limit, agreement >= LW_PARABOLOID_AGREES);
    // Not the other side of a sheet, as near as the side that the texel saw. (Not as the negation of its being that: Oclgrind
    // misreads negated comparisons.)
    const mask front = or_(off > limit, agreement > -LW_PARABOLOID_AGREES);
    return and_(or_(and_(before, front), own), r2 <= LW_PARABOLOID_RIM * LW_PARABOLOID_RIM);
}

// The same; two gathers.
LW_FN mask paraboloid_texel_lit(__global const float* records, int firstRecord, int size, lanei x, lanei y,
                                lw_map_receiver r) {
    const lanei at = paraboloid_record(firstRecord, size, x, y);
    return record_lit(gather(records, at), gatheri((__global const int*)records, at + 1), size, x, y, r);
}

// Rounding may leave the map by less than a texel: below, the conversion towards zero brings it back.
LW_FN lanei nearest_texel(int size, real x) { return min(to_lanei(x + 0.5f), (lanei)(size - 1)); }

// Hard: the nearest texel decides. Where the map saw nothing: lit. Beyond the rim: dark, as behind the surface that the medoid
// lies on; lit there, clusters with members on either side of an edge shine through walls. `firstRecord`: of the map.
LW_FN mask paraboloid_sees(__global const float* records, int firstRecord, int size, lw_map_receiver r) {
    const lanei x = nearest_texel(size, r.x), y = nearest_texel(size, r.y);
    return and_(r.inside, paraboloid_texel_lit(records, firstRecord, size, x, y, r));
}

// The four texels around a receiver, and where it lies between their centres.
typedef struct {
    lanei x0, y0, x1, y1;
    real fx, fy;  // in [0,1]: 0 at x0, y0
} lw_four_texels;

LW_FN lw_four_texels texels_around(int size, lw_map_receiver r) {
    const real last = (float)(size - 1);
    const real x = fmin(fmax(r.x, 0.0f), last), y = fmin(fmax(r.y, 0.0f), last);
    lw_four_texels t;
    t.x0 = to_lanei(x);
    t.y0 = to_lanei(y);
    t.x1 = min(t.x0 + 1, (lanei)(size - 1));
    t.y1 = min(t.y0 + 1, (lanei)(size - 1));
    t.fx = x - to_real(t.x0);
    t.fy = y - to_real(t.y0);
    return t;
}

// Soft, in [0,1]: the share of the four nearest texels that are lit, weighted bilinearly (percentage-closer
// filtering, Reeves et al. 1987). Eight gathers.
LW_FN real paraboloid_visibility(__global const float* records, int firstRecord, int size, lw_map_receiver r) {
    const lw_four_texels t = texels_around(size, r);
    const real a = ones_(paraboloid_texel_lit(records, firstRecord, size, t.x0, t.y0, r));
    const real b = ones_(paraboloid_texel_lit(records, firstRecord, size, t.x1, t.y0, r));
    const real c = ones_(paraboloid_texel_lit(records, firstRecord, size, t.x0, t.y1, r));
    const real d = ones_(paraboloid_texel_lit(records, firstRecord, size, t.x1, t.y1, r));
    const real upper = fma_(t.fx, b - a, a), lower = fma_(t.fx, d - c, c);
    return select_((real)(0.0f), fma_(t.fy, lower - upper, upper), r.inside);
}

// Strict: as hard; `doubtful` where the map's marks say so (paraboloid_map_marks). Light that passes along the rim of what hides a lit
// surface is as strong as that surface is bright, and rules the error of dark rooms.
LW_FN mask paraboloid_sees_strictly(__global const float* records, int firstRecord, int size, lw_map_receiver r, mask* doubtful) {
    const lanei x = nearest_texel(size, r.x), y = nearest_texel(size, r.y), at = paraboloid_record(firstRecord, size, x, y);
    const lanei bits = gatheri((__global const int*)records, at + 1);
    const mask seen = and_(r.inside, record_lit(gather(records, at), bits, size, x, y, r));
    *doubtful = and_(seen, bits < 0);  // LW_PARABOLOID_DOUBTFUL is the sign
    return seen;
}

#endif
