// Irradiance from the cells of a sweep: what arrives at the six sides of the eight cells around a point, each cell as much as it is
// open. Cells that surfaces fill see nothing of the room; without their weight light would be missing along edges, and light from
// behind a wall would come through where a cell reaches across it.
#ifndef LW_LPV_SWEEP_CELLS_H
#define LW_LPV_SWEEP_CELLS_H

#include "lpv_sweep_types.h"

// Of the cells' centres above the surface, in cells; just below 0, so that rounding does not choose where they lie on it.
#define SWEEP_LEAST_HEIGHT -1e-3f

// A coordinate in cells, from the first one's centre, to the lower of the two cells around it and the upper one's share.
LW_FN float sweep_split(float g, int size, int* lower) {
    const float inside = clamp(g, 0.0f, (float)(size - 1));
    *lower = min((int)inside, size - 2);
    return inside - (float)*lower;
}

// What the eight cells around a point count, numbered by x (1), y (2), z (4): shares f of the upper ones. n: the surface's unit normal;
// above: how far the point is off the surface, in cells.
//
// Cells whose centres lie behind the surface do not count. Which of the two cells at a sheet is closed depends on the side that its
// own normal faces; where that is the reader's, the open one lies beyond the sheet, and the reader would get the other side's light.
// number, keep, choose: floats of one reader, or lanes of several.
#define SWEEP_WEIGH(number, keep, choose, f, n, above)                                                                       \
    {                                                                                                                        \
        const number height_ = (above) - ((f)[0] * (n)[0] + (f)[1] * (n)[1] + (f)[2] * (n)[2]);                              \
        _Pragma("unroll") for (int k = 0; k < 8; ++k) {                                                                      \
            const number share_ = ((k & 1) ? (f)[0] : 1.0f - (f)[0]) * ((k & 2) ? (f)[1] : 1.0f - (f)[1]) *                  \
                                  ((k & 4) ? (f)[2] : 1.0f - (f)[2]);                                                        \
            const number at_ = height_ + (((k & 1) ? 1.0f : 0.0f) * (n)[0] + ((k & 2) ? 1.0f : 0.0f) * (n)[1] +              \
                                          ((k & 4) ? 1.0f : 0.0f) * (n)[2]);                                                 \
            keep(k, (above) < 1.5f ? choose((number)(0.0f), share_, at_ > SWEEP_LEAST_HEIGHT) : share_);                     \
        }                                                                                                                    \
    }
// (From 1.5 cells above only a corner of next to no share can lie behind.)

// What arrives at the six sides of the eight cells from `corner` on, at weights[k * stride]: +x, -x, +y, -y in xy, +z, -z in zz, in
// the fourth number of each of how much is open.
LW_FN void sweep_arriving(__global const float16* corner, int size, const float* weights, int stride, float16* xy, float8* zz) {
    *xy = (float16)(0.0f);
    *zz = (float8)(0.0f);
    _Pragma("unroll") for (int k = 0; k < 8; ++k) {
        const float w = weights[k * stride];
        __global const float16* cell = corner + 2 * (((k & 1) ? 1 : 0) + ((k & 2) ? size : 0) + ((k & 4) ? size * size : 0));
        *xy += w * cell[0];
        *zz += w * *(__global const float8*)(cell + 1);
    }
}

// What they are to a surface: nx, ny, nz are the squares of its normal's coordinates, of the positive (first) and the negative
// ones. Of each cell all six sides are loaded: a pixel that picked its three would load longer.
LW_FN float4 sweep_sides(__global const float16* corner, int size, const float* weights, int stride, float2 nx, float2 ny, float2 nz) {
    float16 xy;
    float8 zz;
    sweep_arriving(corner, size, weights, stride, &xy, &zz);
    return nx.x * xy.s0123 + nx.y * xy.s4567 + ny.x * xy.s89ab + ny.y * xy.scdef + nz.x * zz.s0123 + nz.y * zz.s4567;
}

// Light and readers are half a cell off their surfaces, which makes every distance a cell shorter. What light loses over one more
// cell is what it lost over the last: E1 at half a cell, E2 at one and a half, E = E1 min(1, E1 / E2). Of their sweep_sides.
LW_FN float4 sweep_less(float4 near, float4 far) {
    const float4 e1 = near / near.w, e2 = far / far.w;
    // Where e2 is not above e1 the quotient is not below 1, or 0 / 0.
    return e1 * select((float4)(1.0f), e1 / e2, e2 > e1);
}

LW_FN float2 sweep_squares(float n) {
    const float2 parts = (float2)(fmax(n, 0.0f), fmin(n, 0.0f));
    return parts * parts;
}

// E of a surface of unit normal n at (x, y, z), in cells from the grid's corner, read twice:
// E(n) = sum over axes of n_i^2 q(side that n_i faces), exact along the axes.
LW_FN float4 sweep_read_twice(__global const float16* cells, int size, float x, float y, float z, float nx, float ny, float nz) {
    const float2 sx = sweep_squares(nx), sy = sweep_squares(ny), sz = sweep_squares(nz);
    const float n[3] = {nx, ny, nz};
    float4 light[2];
    for (int i = 0; i < 2; ++i) {
        int ix, iy, iz;
        const float above = (float)i + 0.5f;
        const float f[3] = {sweep_split(x + above * nx - 0.5f, size, &ix), sweep_split(y + above * ny - 0.5f, size, &iy),
                            sweep_split(z + above * nz - 0.5f, size, &iz)};
        float weights[8];
#define SWEEP_KEEP(k, weight) weights[k] = (weight)
#define SWEEP_CHOOSE(otherwise, value, condition) ((condition) ? (value) : (otherwise))
        SWEEP_WEIGH(float, SWEEP_KEEP, SWEEP_CHOOSE, f, n, above)
#undef SWEEP_KEEP
#undef SWEEP_CHOOSE
        light[i] = sweep_sides(cells + 2 * ((iz * size + iy) * size + ix), size, weights, 1, sx, sy, sz);
    }
    return sweep_less(light[0], light[1]);
}

#endif
