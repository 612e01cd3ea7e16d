// A texel of the pyramid, how four make one, and how it lies in memory. A program defines
// LW_PYRAMID_RADIANCE, LW_PYRAMID_AREA, LW_PYRAMID_DEPTH as 1 or 0, and LW_PYRAMID_PLANES, their planes in all.
#ifndef LW_MIP_PYRAMID_H
#define LW_MIP_PYRAMID_H

#include "shared/edge_weight.h"
#include "shared/pyramid_types.h"
#include "shared/surface.h"

#define LW_UNROLL _Pragma("unroll")

typedef struct {
    lw_surface s;  // unit normal; zero without a surface
    real r, g, b;  // direct radiance, W/(sr m^2)
    real area;     // of the surface that the texel shows, m^2; 0: it sends nothing
    real depth;    // along the camera's axis
} lw_texel;

LW_FN real axial_depth(const lw_surface s, const LwPyramidCamera c) {
    return fma_(s.px - c.eye.x, (real)c.axis.x, fma_(s.py - c.eye.y, (real)c.axis.y, (s.pz - c.eye.z) * c.axis.z));
}

// Area of the surface that a base pixel shows (Soler et al. 2009, eq. 2, with the halves of the angles):
// a0 z^2 cos(alpha) / cos(beta), a0 the pixel's area at distance 1, alpha between ray and axis, beta between ray
// and normal. With v from the eye to the surface, cos(alpha) = z / |v| and cos(beta) = -n.v / |v|, so that it is
// a0 z^3 / -n.v. An orthographic camera's rays are its axis and its pixels equal: a0 / -n.axis.
LW_FN real pixel_area(const lw_surface s, real depth, const LwPyramidCamera c) {
    const int perspective = c.axis.w != 0.0f;
    const real z = perspective ? fmax(depth, (real)0.0f) : (real)1.0f;
    const real vx = perspective ? s.px - c.eye.x : (real)c.axis.x, vy = perspective ? s.py - c.eye.y : (real)c.axis.y,
               vz = perspective ? s.pz - c.eye.z : (real)c.axis.z;
    const real along = -fma_(s.nx, vx, fma_(s.ny, vy, s.nz * vz));
    const real length = sqrt(squared_length(vx, vy, vz));
    const real a = c.eye.w * z * z * z / fmax(along, LW_MIN_VIEW_COSINE * length);
    return select_((real)0.0f, a, and_(s.valid, length > 0.0f));
}

// b instead of a: the first surface, one that sends before one that only receives, the nearer one.
LW_FN mask goes_before(const lw_texel* a, const lw_texel* b) {
    mask before = b->depth < a->depth;
#if LW_PYRAMID_AREA
    const mask sends = b->area > 0.0f, rival = a->area > 0.0f;
    before = or_(and_(sends, not_(rival)), and_(before, or_(sends, not_(rival))));
#endif
    return and_(b->s.valid, or_(not_(a->s.valid), before));
}

LW_FN void keep_nearer(lw_texel* kept, const lw_texel* other) {
    const mask take = goes_before(kept, other);
    kept->s.px = select_(kept->s.px, other->s.px, take);
    kept->s.py = select_(kept->s.py, other->s.py, take);
    kept->s.pz = select_(kept->s.pz, other->s.pz, take);
    kept->s.nx = select_(kept->s.nx, other->s.nx, take);
    kept->s.ny = select_(kept->s.ny, other->s.ny, take);
    kept->s.nz = select_(kept->s.nz, other->s.nz, take);
    kept->area = select_(kept->area, other->area, take);
    kept->depth = select_(kept->depth, other->depth, take);
    kept->s.valid = or_(kept->s.valid, take);
}

// What the children on the kept surface show together. With the plane of areas: their total area, and place and mean
// radiance weighted by it, so that the flux of a surface is the same on every level and comes from the middle of it. (The
// nearest child's own place is up to half a texel nearer the camera: a floor that lights the wall behind it is then farther
// from the wall by that, and the wall 3 % brighter where rings are 10 texels wide.) Children that only receive have no area;
// where all do, the kept one's place stays. Without the plane: the kept child's place, and the plain mean.
LW_FN lw_texel merged(const lw_texel* child, const int first) {
    lw_texel t = child[first];
    LW_UNROLL for (int i = 1; i < 4; ++i) keep_nearer(&t, &child[(first + i) & 3]);
    const lw_edges edges = edges_of(t.s, (real)1.0f);
    const real keptDepth = t.depth;
    real w[4], weight = (real)0.0f;
    LW_UNROLL for (int i = 0; i < 4; ++i) {
        const lw_texel* c = &child[i];
        const mask on = and_(and_(c->s.valid, t.s.valid),
                             edge_weight(edges, c->s.px, c->s.py, c->s.pz, c->s.nx, c->s.ny, c->s.nz) > 0.0f);
#if LW_PYRAMID_AREA
        w[i] = select_((real)0.0f, c->area, on);
#else
        w[i] = ones_(on);
#endif
        weight += w[i];
    }
    // Shares first: radiance times area might leave float's range.
    const real scale = select_((real)0.0f, 1.0f / weight, weight > 1e-37f);
    t.r = t.g = t.b = (real)0.0f;
    LW_UNROLL for (int i = 0; i < 4; ++i) {
        const lw_texel* c = &child[i];
        const real share = w[i] * scale;
        t.r = fma_(share, c->r, t.r);
        t.g = fma_(share, c->g, t.g);
        t.b = fma_(share, c->b, t.b);
#if LW_PYRAMID_AREA
        t.s.px = fma_(share, c->s.px - edges.px, t.s.px);
        t.s.py = fma_(share, c->s.py - edges.py, t.s.py);
        t.s.pz = fma_(share, c->s.pz - edges.pz, t.s.pz);
        t.depth = fma_(share, c->depth - keptDepth, t.depth);
#endif
    }
    t.area = weight;
    return t;
}

// Planes from `at` (the texel's first float) on, `plane` apart.
LW_FN void store_texel(const lw_texel* t, __global float* out, int at, int plane) {
    store(t->s.px, out, at);
    store(t->s.py, out, at + plane);
    store(t->s.pz, out, at + 2 * plane);
    store(t->s.nx, out, at + 3 * plane);
    store(t->s.ny, out, at + 4 * plane);
    store(t->s.nz, out, at + 5 * plane);
    int next = at + 6 * plane;
#if LW_PYRAMID_RADIANCE
    store(t->r, out, next);
    store(t->g, out, next + plane);
    store(t->b, out, next + 2 * plane);
    next += 3 * plane;
#endif
#if LW_PYRAMID_AREA
    store(t->area, out, next);
    next += plane;
#endif
#if LW_PYRAMID_DEPTH
    store(select_((real)0.0f, t->depth, t->s.valid), out, next);
#endif
}

#endif
