// How much a neighbouring surface's light counts for a pixel: nothing across a depth or normal edge.
// Free of units: distances are compared with each other only.
#ifndef LW_EDGE_WEIGHT_H
#define LW_EDGE_WEIGHT_H

#include "surface.h"

// A neighbour at offset d belongs to the same surface when it lies within this slope of the pixel's
// tangent plane: |n.d| <= slope |d|. Larger: light crosses steps lower than slope * pixel spacing.
// Smaller: smooth normals of coarse meshes lean away from their triangles, by 15 to 30 degrees on the
// vaults of Sponza, and the interleaving pattern stays there (seen at 0.25 and, faintly, at 0.5).
#define LW_EDGE_SLOPE 0.7f
// Cosine between normals at which a neighbour stops counting; full weight at 1, linear between.
// Lower: light bleeds around corners and over small curvature. Higher: noise on normal-mapped surfaces.
#define LW_EDGE_NORMAL_COSINE 0.8f

// `scale` brings the neighbour's normal to unit length. A raw neighbour is given the pixel's own scale: a
// G-buffer's normals share one length (or nearly), and the pixel itself then has a weight of exactly 1.
LW_FN real edge_weight(const lw_surface s, real qx, real qy, real qz, real mx, real my, real mz, real scale) {
    const real dx = qx - s.px, dy = qy - s.py, dz = qz - s.pz;
    const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
    const real off = fma_(dx, s.nx, fma_(dy, s.ny, dz * s.nz));
    const real agreement = scale * fma_(mx, s.nx, fma_(my, s.ny, mz * s.nz));
    const real w = fmin((agreement - LW_EDGE_NORMAL_COSINE) * (1.0f / (1.0f - LW_EDGE_NORMAL_COSINE)), (real)1.0f);
    // NaN in a neighbour fails both comparisons.
    return select_((real)0.0f, w, and_(off * off <= (LW_EDGE_SLOPE * LW_EDGE_SLOPE) * d2, w > 0.0f));
}

#endif
