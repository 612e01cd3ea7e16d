// What a point is to a kernel, a place with a normal or without one, and the light that arrives there in two bands of spherical
// harmonics: L(d) = Y0 c0 + Y1 (c1 . d), d towards the light.
#ifndef LW_POINTS_H
#define LW_POINTS_H

#include "surface.h"

#define LW_BANDS_Y0 0.2820947918f  // 1 / (2 sqrt(pi))
#define LW_BANDS_Y1 0.4886025119f  // sqrt(3 / (4 pi))

// The points of LW_WIDTH columns of row y from x on, as load_surface has them; without normals all that lie within reach.
LW_FN lw_surface load_point(__global const float* position, int4 positionLayout, __global const float* normal,
                            int4 normalLayout, int hasNormals, int x, int y) {
    if (hasNormals) return load_surface(position, positionLayout, normal, normalLayout, x, y);
    const int p = positionLayout.x + y * positionLayout.y + x, plane = positionLayout.z;
    const real px = load(position, p), py = load(position, p + plane), pz = load(position, p + 2 * plane), none = (real)0.0f;
    lw_surface s;
    s.valid = is_within_reach(px, py, pz);
    s.rejected = not_(s.valid);
    s.scale = none;
    s.px = select_(none, px, s.valid);
    s.py = select_(none, py, s.valid);
    s.pz = select_(none, pz, s.valid);
    s.nx = s.ny = s.nz = none;
    return s;
}

// c0, c1.x, c1.y, c1.z of three colours.
typedef struct { real c[4][3]; } lw_bands;

// Writes them, `band` floats from one band to the next and layout.z from colour to colour; 0 where there is no light to be had.
// True lanes of the result had numbers beyond LW_LARGEST_IRRADIANCE, which are brought down to it, or opposite ones beyond
// float's range, whose sum is taken for 0.
LW_FN mask store_bands(lw_bands light, mask has, __global float* harmonics, int4 layout, int band, int x, int y) {
    const real none = (real)0.0f, most = (real)LW_LARGEST_IRRADIANCE;
    mask saturated = splat_mask(0);
    for (int b = 0; b < 4; ++b)
        for (int c = 0; c < 3; ++c) {
            const real v = select_(none, light.c[b][c], has);
            saturated = or_(saturated, not_(fabs(v) <= most));
            const real bounded = select_(fmin(fmax(v, -most), most), none, isnan(v));
            store(bounded, harmonics, layout.x + y * layout.y + x + b * band + c * layout.z);
        }
    return saturated;
}

#endif
