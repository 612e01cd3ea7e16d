// How much a neighbouring surface's light counts for a pixel: nothing across a depth or normal edge.
// Free of units: distances are compared with each other only.
#ifndef LW_EDGE_WEIGHT_H
#define LW_EDGE_WEIGHT_H

#include "surface.h"

// A neighbour at offset d belongs to the same surface when it lies within this slope of the pixel's
// tangent plane: |n.d| <= slope |d|. Larger: light crosses steps lower than slope * pixel spacing.
// Smaller: smooth normals of coarse meshes lean away from their triangles, by 15 to 30 degrees on the
// vaults of Sponza, and the interleaving pattern stays there (seen at 0.25 and, faintly, at 0.5).
// Filters that take a surface's own slope (edge_slope.h) allow so much where it is this steep.
#define LW_EDGE_SLOPE 0.7f
// Cosine between normals at which a neighbour stops counting; full weight at 1, linear between.
// Lower: light bleeds around corners and over small curvature. Higher: noise on normal-mapped surfaces.
#define LW_EDGE_NORMAL_COSINE 0.8f

// A pixel as its neighbours are measured by it: its place, its normal times a factor that makes the product with a
// neighbour's normal fall from 1 to 0 over the range of the weight, and what that factor makes of the squared slope.
typedef struct {
    real px, py, pz;
    real tx, ty, tz;
    real slope2;
} lw_edges;

// `scale` brings the neighbours' normals to unit length. Raw neighbours are given the pixel's own scale: a
// G-buffer's normals share one length (or nearly), and the pixel itself then has a weight of 1.
LW_FN lw_edges edges_within(const lw_surface s, real scale, real slope2) {
    const real factor = scale * (1.0f / (1.0f - LW_EDGE_NORMAL_COSINE));
    const lw_edges e = {s.px, s.py, s.pz, s.nx * factor, s.ny * factor, s.nz * factor, slope2 * sq(factor)};
    return e;
}

LW_FN lw_edges edges_of(const lw_surface s, real scale) { return edges_within(s, scale, (real)(LW_EDGE_SLOPE * LW_EDGE_SLOPE)); }

// What edge_weight clamps to 0 ... 1, and whether the neighbour lies near the tangent plane.
LW_FN real edge_ramp(const lw_edges e, real mx, real my, real mz) {
    const float least = -LW_EDGE_NORMAL_COSINE / (1.0f - LW_EDGE_NORMAL_COSINE);
    return fma_(mx, e.tx, fma_(my, e.ty, fma_(mz, e.tz, least)));
}

LW_FN mask is_in_plane(const lw_edges e, real qx, real qy, real qz) {
    const real dx = qx - e.px, dy = qy - e.py, dz = qz - e.pz;
    const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
    const real off = fma_(dx, e.tx, fma_(dy, e.ty, dz * e.tz));
    return off * off <= e.slope2 * d2;
}

LW_FN real edge_weight(const lw_edges e, real qx, real qy, real qz, real mx, real my, real mz) {
    const real w = edge_ramp(e, mx, my, mz);
    // NaN in a neighbour fails the comparison.
    return select_((real)0.0f, fmin(w, (real)1.0f), and_(is_in_plane(e, qx, qy, qz), w > 0.0f));
}

// The same bits for a neighbour whose normal is no NaN: floats above 0 are ordered as integers are, which the processor compares beside
// its multiplications.
LW_FN real edge_weight_of_number(const lw_edges e, real qx, real qy, real qz, real mx, real my, real mz) {
    const lanei w = as_lanei_(edge_ramp(e, mx, my, mz));
    return select_((real)0.0f, as_real_(min(max(w, (lanei)0), as_lanei_((real)1.0f))), is_in_plane(e, qx, qy, qz));
}

#endif
