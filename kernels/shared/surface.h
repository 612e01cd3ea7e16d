// What a G-buffer pixel is to a kernel: a point and a unit normal, or nothing.
#ifndef LW_SURFACE_H
#define LW_SURFACE_H

#include "input_limits.h"
#include "wide.h"

typedef struct {
    real px, py, pz;  // world position; 0 without a surface
    real nx, ny, nz;  // unit normal; 0 without a surface
    real scale;       // 1 / length of the normal as the host gave it
    mask valid;       // a surface with a position within LW_LARGEST_DISTANCE and a normal that can be normalised
    mask rejected;    // not a surface although the host did not mark it as background (zero normal)
} lw_surface;

LW_FN real squared_length(real x, real y, real z) { return fma_(x, x, fma_(y, y, z * z)); }

// False for NaN. As the operator <=, Oclgrind 21.10 takes lanes beyond for near ones in joint_bilateral_downsample.
LW_FN mask is_within_reach(real px, real py, real pz) {
    return islessequal(squared_length(px, py, pz), (real)(LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE));
}

// Normals of compact formats are off unit length by quantisation: they are normalised, not refused.
// Shorter than 1/2 or longer than 2 is no normal at all.
LW_FN mask is_surface(real px, real py, real pz, real nx, real ny, real nz) {
    const real n2 = squared_length(nx, ny, nz);
    return and_(and_(n2 > 0.25f, n2 < 4.0f), is_within_reach(px, py, pz));
}

LW_FN lw_surface make_surface(real px, real py, real pz, real nx, real ny, real nz) {
    lw_surface s;
    const real n2 = squared_length(nx, ny, nz);
    s.valid = is_surface(px, py, pz, nx, ny, nz);
    s.rejected = and_(not_(s.valid), not_(n2 == 0.0f));
    s.scale = rsqrt(n2);
    s.px = select_((real)0.0f, px, s.valid);
    s.py = select_((real)0.0f, py, s.valid);
    s.pz = select_((real)0.0f, pz, s.valid);
    s.nx = select_((real)0.0f, nx * s.scale, s.valid);
    s.ny = select_((real)0.0f, ny * s.scale, s.valid);
    s.nz = select_((real)0.0f, nz * s.scale, s.valid);
    return s;
}

// The surfaces of LW_WIDTH pixels of row y from column x on, of a G-buffer's planes (layouts as `Planes`).
LW_FN lw_surface load_surface(__global const float* position, int4 positionLayout, __global const float* normal,
                              int4 normalLayout, int x, int y) {
    const int p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
    const int pz = positionLayout.z, nz = normalLayout.z;
    return make_surface(load(position, p), load(position, p + pz), load(position, p + 2 * pz), load(normal, n),
                        load(normal, n + nz), load(normal, n + 2 * nz));
}

#endif
