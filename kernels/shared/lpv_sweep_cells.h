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

// E of a surface of unit normal n from the cells about the point (x, y, z), in cells from the grid's corner:
// E(n) = sum over axes of n_i^2 q(side that n_i faces), exact along the axes. Of each cell all six sides are loaded: a pixel
// that picked its three would load longer.
//
// above: how far the point is off its surface, in cells. Cells whose centres lie behind the surface do not count. Which of the
// two cells at a sheet is closed depends on the side that its own normal faces; where that is the reader's, the open one lies
// beyond the sheet, and the reader would get the other side's light.
LW_FN float4 sweep_irradiance(__global const float16* cells, int size, float x, float y, float z, float nx, float ny, float nz,
                              float above) {
    int ix, iy, iz;
    const float fx = sweep_split(x - 0.5f, size, &ix), fy = sweep_split(y - 0.5f, size, &iy), fz = sweep_split(z - 0.5f, size, &iz);
    __global const float16* corner = cells + 2 * ((iz * size + iy) * size + ix);
    float16 xy = (float16)(0.0f);
    float8 zz = (float8)(0.0f);
    // Cells are numbered by x (1), y (2), z (4).
    const int8 byX = (int8)(0, -1, 0, -1, 0, -1, 0, -1), byY = (int8)(0, 0, -1, -1, 0, 0, -1, -1),
               byZ = (int8)(0, 0, 0, 0, -1, -1, -1, -1);
    const float8 shares = select((float8)(1.0f - fx), (float8)(fx), byX) * select((float8)(1.0f - fy), (float8)(fy), byY) *
                          select((float8)(1.0f - fz), (float8)(fz), byZ);
    const float8 heights = (above - (fx * nx + fy * ny + fz * nz)) -
                           (convert_float8(byX) * nx + convert_float8(byY) * ny + convert_float8(byZ) * nz);
    float weights[8];
    // From above 1.5 only a corner of next to no share can lie behind.
    vstore8(above < 1.5f ? select((float8)(0.0f), shares, heights > SWEEP_LEAST_HEIGHT) : shares, 0, weights);
    _Pragma("unroll") for (int k = 0; k < 8; ++k) {
        const float w = weights[k];
        __global const float16* cell = corner + 2 * (((k & 1) ? 1 : 0) + ((k & 2) ? size : 0) + ((k & 4) ? size * size : 0));
        xy += w * cell[0];
        zz += w * *(__global const float8*)(cell + 1);
    }
    const float px = fmax(nx, 0.0f), py = fmax(ny, 0.0f), pz = fmax(nz, 0.0f), mx = fmin(nx, 0.0f), my = fmin(ny, 0.0f),
                mz = fmin(nz, 0.0f);
    const float4 sum = px * px * xy.s0123 + mx * mx * xy.s4567 + py * py * xy.s89ab + my * my * xy.scdef + pz * pz * zz.s0123 +
                       mz * mz * zz.s4567;
    return sum / sum.w;
}

// Light and readers are half a cell off their surfaces, which makes every distance a cell shorter. What light loses over one more
// cell is what it lost over the last: E1 at half a cell, E2 at one and a half, E = E1 min(1, E1 / E2).
LW_FN float4 sweep_read_twice(__global const float16* cells, int size, float x, float y, float z, float nx, float ny, float nz) {
    const float4 e1 = sweep_irradiance(cells, size, x + 0.5f * nx, y + 0.5f * ny, z + 0.5f * nz, nx, ny, nz, 0.5f);
    const float4 e2 = sweep_irradiance(cells, size, x + 1.5f * nx, y + 1.5f * ny, z + 1.5f * nz, nx, ny, nz, 1.5f);
    // Where e2 is not above e1 the quotient is not below 1, or 0 / 0.
    return e1 * select((float4)(1.0f), e1 / e2, e2 > e1);
}

#endif
