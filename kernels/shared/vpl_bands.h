// What VPLs send to a vector of points, in two bands of spherical harmonics.
#ifndef LW_VPL_BANDS_H
#define LW_VPL_BANDS_H

#include "points.h"

// A VPL that a point sees in direction d as E, the irradiance of a surface that faces it, adds Y0 E to c0 and Y1 E d to c1:
// exactly, for light from one direction. E is bounded as weigh_two_vpls bounds it, times pi and per watt
//   c_p / (d^2 + (1 + 3 c_p^2)/4 A/pi),
// so that the VPL lights a surface that faces it no other way. facing: E; from: E times the unit vector from the VPL.
LW_FN void reach_two_points(real* facing, real (*from)[3], const lw_surface s, __global const float* const* vpl) {
    real d2[2], w[2];
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        from[u][0] = s.px - vpl[u][0];
        from[u][1] = s.py - vpl[u][1];
        from[u][2] = s.pz - vpl[u][2];
        d2[u] = fma_(from[u][0], from[u][0], fma_(from[u][1], from[u][1], from[u][2] * from[u][2]));
        w[u] = fmax(fma_(from[u][0], vpl[u][4], fma_(from[u][1], vpl[u][5], from[u][2] * vpl[u][6])), (real)0.0f);
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        // The smallest float keeps a point that *is* the VPL at 0 / tiny = 0.
        const real bound = fma_(fma_(3.0f * w[u], w[u], d2[u]), vpl[u][7], 1e-37f);
        const real t = w[u] / fma_(d2[u], d2[u], bound);
        facing[u] = t * sqrt(d2[u]);
        LW_UNROLL for (int a = 0; a < 3; ++a) from[u][a] *= t;
    }
}

LW_FN void add_bands(lw_bands* sum, real facing, const real* from, real seen, __global const float* vpl) {
    LW_UNROLL for (int c = 0; c < 3; ++c) {
        const real flux = seen * vpl[8 + c];
        sum->c[0][c] = fma_(facing, flux, sum->c[0][c]);
        LW_UNROLL for (int a = 0; a < 3; ++a) sum->c[1 + a][c] = fma_(from[a], flux, sum->c[1 + a][c]);
    }
}

LW_FN void scale_bands(lw_bands* sum, real by) {
    LW_UNROLL for (int b = 0; b < 4; ++b) LW_UNROLL for (int c = 0; c < 3; ++c) sum->c[b][c] *= by;
}

LW_FN lw_bands no_bands(void) {
    lw_bands none;
    LW_UNROLL for (int b = 0; b < 4; ++b) LW_UNROLL for (int c = 0; c < 3; ++c) none.c[b][c] = (real)0.0f;
    return none;
}

// What the sum of add_bands means: it was taken without the 1/pi, and with vectors that point away from the light.
LW_FN lw_bands finish_bands(lw_bands sum) {
    LW_UNROLL for (int c = 0; c < 3; ++c) {
        sum.c[0][c] *= LW_BANDS_Y0 * M_1_PI_F;
        LW_UNROLL for (int a = 1; a < 4; ++a) sum.c[a][c] *= -LW_BANDS_Y1 * M_1_PI_F;
    }
    return sum;
}

#endif
