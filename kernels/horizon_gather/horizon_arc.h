// A slice of the directions around a pixel: the half-plane bundle through the way to the eye V and one line of the
// image. Angles theta count from V; gamma is the angle of the normal's projection into the slice. Sector borders lie at
// equal steps of the cumulative measure
//   LW_UNIFORM 0:  |n_proj| cos(theta - gamma) |sin(theta)|   (cosine-weighted)
//   LW_UNIFORM 1:  |sin(theta)|                               (every direction alike)
// which docs/techniques/horizon.md derives. Angles themselves are never computed, only their cosines.
#ifndef LW_HORIZON_ARC_H
#define LW_HORIZON_ARC_H

#include "shared/horizon_types.h"
#include "shared/surface.h"

typedef struct {
    real cosine, sine;  // of gamma; sine: positive where the normal leans to the side along the line
    real total;         // the measure of the whole slice
    real middle;        // sectors before V, counted from the end of the side against the line
    real weight;        // the slice's share of everything: sums to 1 over all slices, up to quadrature
    real along, across; // the line's world vector per pixel: its part along V, and its length across V
} lw_arc;

// 1 / sqrt(x) within 5e-6: a first guess from the exponent's bits, two steps of Newton. On CPUs root and division share one
// slow unit; five exact roots in each step of the gather took two thirds of its time. Finite for x = 0.
LW_FN real inverse_root(real x) {
    real y = as_real_((laneu)0x5f375a86u - (as_laneu_(x) >> 1));
    const real h = -0.5f * x;
    y *= fma_(h * y, y, (real)1.5f);
    return y * fma_(h * y, y, (real)1.5f);
}

// fmax and fmin without their rules for NaN, which cost three instructions more each: of a NaN in `a` comes b.
LW_FN real larger(real a, real b) { return select_(b, a, a > b); }
LW_FN real smaller(real a, real b) { return select_(b, a, a < b); }

// arccos(c) - c sqrt(1 - c^2), the area of the unit circle's segment beyond c. Smooth but for the factor
// (1 - c)^(3/2), so that one root and a polynomial do: within 6e-6 for c in [-1, 1].
LW_FN real segment(real c) {
    const real a = fabs(c), q = 1.0f - a;
    const real p = fma_(fma_(fma_((real)0.0112199113f, a, (real)-0.0518844821f), a, (real)0.3558694691f), a, (real)1.5708017033f);
    const real h = q * q * inverse_root(q) * p;
    return select_(h, M_PI_F - h, c < 0.0f);
}

// Least cosine of gamma: a shading normal that faces away from the eye is taken to lie just in view. Smaller: its slice
// degenerates. Larger: the horizon of surfaces seen at grazing angles is wrong by that much.
#define LW_LEAST_FACING 1e-3f

// nx, ny, nz: unit normal; vx, vy, vz: V; share, and the line's direction in the image as a world vector.
LW_FN lw_arc make_arc(real nx, real ny, real nz, real vx, real vy, real vz, float lx, float ly, float lz, real crossSection,
                      float share) {
    lw_arc arc;
    const real lv = fma_(vx, (real)lx, fma_(vy, (real)ly, vz * lz));
    const real tx = lx - vx * lv, ty = ly - vy * lv, tz = lz - vz * lv;
    const real t2 = squared_length(tx, ty, tz), scale = rsqrt(t2);
    const real nv = fmax(fma_(nx, vx, fma_(ny, vy, nz * vz)), (real)LW_LEAST_FACING);
    const real nt = fma_(nx, tx, fma_(ny, ty, nz * tz)) * scale;
    const real projected = sqrt(fma_(nv, nv, nt * nt)), inverse = 1.0f / projected;
    arc.cosine = fmin(nv * inverse, (real)1.0f);
    arc.sine = nt * inverse;
    // Equal steps of angle in the image are not equal steps about V: d(phi about V) / d(phi in the image).
    arc.along = lv;
    arc.across = t2 * scale;
    const real turn = share * crossSection * scale * scale;
#if LW_UNIFORM
    arc.total = (real)2.0f;
    arc.middle = (0.5f * LW_HORIZON_SECTORS) * (1.0f - arc.sine);
    arc.weight = turn;
#else
    const real gamma = fma_(arc.cosine, fabs(arc.sine), segment(arc.cosine));  // unsigned
    arc.total = fma_(gamma, fabs(arc.sine), arc.cosine);
    const real before = 0.5f * (arc.cosine - arc.sine * (0.5f * M_PI_F - select_(gamma, -gamma, arc.sine < 0.0f)));
    arc.middle = LW_HORIZON_SECTORS * before / arc.total;
    arc.weight = turn * projected * arc.total;
#endif
    return arc;
}

// Sectors of a side: `before` V, and factors of sin^2 and of the segment; the border at which it leaves the hemisphere, where
// the cosine falls below `horizon`.
typedef struct {
    real before, square, segment, horizon;
    float last;
} lw_measure;

// sign: 1 along the line, -1 against it. rounding: borders are rounded down after adding it.
LW_FN lw_measure measure_of(const lw_arc arc, float sign, float rounding) {
    const real scale = (0.5f * LW_HORIZON_SECTORS) / arc.total;
    // The sine of gamma has the side's sign, too.
    const lw_measure m = {arc.middle + rounding, sign * scale * arc.cosine, scale * arc.sine, -sign * arc.sine,
                          sign > 0.0f ? LW_HORIZON_SECTORS + 0.5f : 0.5f};
    return m;
}

// arccos(c) - c s of a direction with cosine c and sine s: s^3 times a polynomial of |c|, which takes no root where the sine
// is known. Within 8e-6.
LW_FN real segment_of(real c, real s, real s2) {
    const real a = fabs(c);
    real p = fma_((real)0.318432748f, a, (real)-1.210449387f);
    p = fma_(p, a, (real)2.128059283f);
    p = fma_(p, a, (real)-2.473754774f);
    p = fma_(p, a, (real)2.333408837f);
    p = fma_(p, a, (real)-1.998970950f);
    p = fma_(p, a, (real)1.570788706f);
    const real h = s2 * s * p;
    return select_(h, M_PI_F - h, c < 0.0f);
}

// Number of the sector border nearest to the direction with parts x along V and y >= 0 across it. Always in 0 ..
// LW_HORIZON_SECTORS: the measure ends at the whole of its side, and the rounding keeps what is added to it off the borders.
LW_FN lanei border_of(const lw_measure* m, real x, real y) {
    const real inverse = inverse_root(fma_(x, x, y * y));
    const real c = x * inverse;
#if LW_UNIFORM
    const real sectors = fma_((real)(m->last > 1.0f ? 0.5f * LW_HORIZON_SECTORS : -0.5f * LW_HORIZON_SECTORS), 1.0f - c, m->before);
#else
    const real s = y * inverse, s2 = s * s;
    const real sectors = fma_(m->square, s2, fma_(m->segment, segment_of(c, s, s2), m->before));
#endif
    return to_lanei(select_(sectors, (real)m->last, c < m->horizon));
}

// The bits of the sectors between two borders, whichever is first. A word has a bit more than there are sectors, so that no
// shift is as long as the word.
LW_FN laneu sectors_between(lanei a, lanei b) { return ((laneu)0xffffffffu << as_laneu_(a)) ^ ((laneu)0xffffffffu << as_laneu_(b)); }

// Bits in halves, quarters, .. of a word. (popcount of a vector runs lane by lane in some drivers, ten times slower.)
LW_FN real count_sectors(laneu bits) {
    bits -= (bits >> 1) & 0x55555555u;
    bits = (bits & 0x33333333u) + ((bits >> 2) & 0x33333333u);
    bits = (bits + (bits >> 4)) & 0x0f0f0f0fu;
    return to_real((bits * 0x01010101u) >> 24);
}

#endif
