// Irradiance from the cells of a sweep: what arrives at the six sides of the eight cells around a point, each cell as much as it is
// open. Cells that surfaces fill see nothing of the room; without their weight light would be missing along edges, and light from
// behind a wall would come through where a cell reaches across it.
#ifndef LW_LPV_SWEEP_CELLS_H
#define LW_LPV_SWEEP_CELLS_H

#include "lpv_sweep_types.h"

// A coordinate in cells, from the first one's centre, to the lower of the two cells around it and the upper one's share.
LW_FN float sweep_split(float g, int size, int* lower) {
    const float inside = clamp(g, 0.0f, (float)(size - 1));
    *lower = min((int)inside, size - 2);
    return inside - (float)*lower;
}

// What the six sides of the eight cells from `corner` on, at the shares f of the upper ones, are to a surface: nx, ny, nz are the
// squares of its normal's coordinates, of the positive (first) and the negative ones. In the fourth number: of how much is open. Of
// each cell all six sides are loaded: a pixel that picked its three would load longer.
LW_FN float4 sweep_sides(__global const float16* corner, int size, float fx, float fy, float fz, float2 nx, float2 ny, float2 nz) {
    float16 xy = (float16)(0.0f);
    float8 zz = (float8)(0.0f);
    _Pragma("unroll") for (int k = 0; k < 8; ++k) {
        const float w = ((k & 1) ? fx : 1.0f - fx) * ((k & 2) ? fy : 1.0f - fy) * ((k & 4) ? fz : 1.0f - fz);
        __global const float16* cell = corner + 2 * (((k & 1) ? 1 : 0) + ((k & 2) ? size : 0) + ((k & 4) ? size * size : 0));
        xy += w * cell[0];
        zz += w * *(__global const float8*)(cell + 1);
    }
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
    float4 light[2];
    for (int i = 0; i < 2; ++i) {
        int ix, iy, iz;
        const float off = (float)i + 0.5f, fx = sweep_split(x + off * nx - 0.5f, size, &ix),
                    fy = sweep_split(y + off * ny - 0.5f, size, &iy), fz = sweep_split(z + off * nz - 0.5f, size, &iz);
        light[i] = sweep_sides(cells + 2 * ((iz * size + iy) * size + ix), size, fx, fy, fz, sx, sy, sz);
    }
    return sweep_less(light[0], light[1]);
}

#endif
