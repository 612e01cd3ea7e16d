// What VPLs send to a vector of surfaces.
#ifndef LW_VPL_LIGHT_H
#define LW_VPL_LIGHT_H

#include "interleave.h"
#include "surface.h"

// Irradiance times pi, per watt of flux, of two VPLs at one vector of surfaces, with the bounded point-to-disc term
//   Phi c_p c / (d^2 + (1 + 3 c_p^2)/4 A/pi),
// written with the unnormalised dot products C = c d and C_p = c_p d:
//   Phi C C_p / (d^4 + (d^2 + 3 C_p^2) A/4pi),
// which needs one division and no square root: on CPUs these two share one slow unit.
// The smallest float keeps a pixel that *is* the VPL at 0 / tiny = 0. Two VPLs at a time: their chains
// of dependent operations then overlap, which one chain alone is too long for.
// `away`: the surface with its normal turned round, so that the offset from VPL to surface serves both
// cosines without a sign to change.
LW_FN void weigh_two_vpls(real* w, const lw_surface away, __global const float* const* vpl) {
    real dx[2], dy[2], dz[2], d2[2], c[2];
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        dx[u] = away.px - vpl[u][0];
        dy[u] = away.py - vpl[u][1];
        dz[u] = away.pz - vpl[u][2];
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) d2[u] = fma_(dx[u], dx[u], fma_(dy[u], dy[u], dz[u] * dz[u]));
    LW_UNROLL for (int u = 0; u < 2; ++u)
        c[u] = fmax(fma_(dx[u], away.nx, fma_(dy[u], away.ny, dz[u] * away.nz)), (real)0.0f);
    LW_UNROLL for (int u = 0; u < 2; ++u)
        w[u] = fmax(fma_(dx[u], vpl[u][4], fma_(dy[u], vpl[u][5], dz[u] * vpl[u][6])), (real)0.0f);
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        const real bound = fma_(fma_(3.0f * w[u], w[u], d2[u]), vpl[u][7], 1e-37f);
        w[u] = c[u] * w[u] / fma_(d2[u], d2[u], bound);
    }
}

LW_FN void add_light(rgb* e, real w, __global const float* vpl) {
    e->r = fma_(w, vpl[8], e->r);
    e->g = fma_(w, vpl[9], e->g);
    e->b = fma_(w, vpl[10], e->b);
}

// The surface with its normal turned round, as weigh_two_vpls wants it.
LW_FN lw_surface turned_away(lw_surface s) {
    s.nx = -s.nx;
    s.ny = -s.ny;
    s.nz = -s.nz;
    return s;
}

#endif
