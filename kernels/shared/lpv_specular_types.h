// Cells that specular rays march through: what kernels and host share.
//
// A cell is 16 floats, four for each of four vectors: c0, c1.x, c1.y, c1.z of what its surfaces send, of red, green and blue, as
// flux / (pi s^2) and that times the normal, in W/(sr m^2); and in the fourth place of the first three vectors how much of a way
// through the cell along x, y and z is closed, 0 to 1. Cells of every level lie x first, then y, then z; behind them those of the next
// level, half as many a side.
#ifndef LW_LPV_SPECULAR_TYPES_H
#define LW_LPV_SPECULAR_TYPES_H

#include "portable.h"

#define LW_SPECULAR_CELL 16

// Rays of a lobe, and the largest roughness that takes one ray alone: its lobe is narrower than a cell at a dozen cells' distance.
#define LW_SPECULAR_RAYS 8
#define LW_SPECULAR_ONE_RAY 0.2f
// Of a ray's share of directions, a cone, how wide its cells are, by the cone's width: less takes time; more darkens what the ray passes
// aslant, since in wide cells a wall's light and the wall itself are the same cell (in a box of lit walls 0.79 of the light is left of
// roughness 1, for 0.86).
#define LW_SPECULAR_WIDTH 0.5f
// Where rays begin, in cells off the surface.
#define LW_SPECULAR_START 0.5f
// What still gets through is taken for nothing below this.
#define LW_SPECULAR_LEAST 1e-3f

// How far empty cells are counted. More: rays leap further, counting takes longer.
#define LW_SPECULAR_FAR 8.0f

// Levels of a grid, the coarsest of four cells a side.
LW_FN lw_int specular_levels(lw_int size) {
    lw_int levels = 1;
    for (lw_int n = size; n > 4; n /= 2) ++levels;
    return levels;
}

// The first cell of a level; of the one behind the last: the number of cells.
LW_FN lw_int specular_first(lw_int size, lw_int level) {
    lw_int first = 0;
    for (lw_int n = size, l = 0; l < level; ++l, n /= 2) first += n * n * n;
    return first;
}

// Where a view's rays come from, and what is where no cell is.
typedef struct {
    lw_float4 eye;          // xyz: of a perspective camera, with w = 1; or the way towards an orthographic one, or back, with w = 0
    lw_float4 environment;  // rgb, W/(sr m^2)
    lw_float4 roughness;    // x: of pixels where there is no image of it
} LwSpecularRays;
LW_SIZE_CHECK(LwSpecularRays, 48);

#endif
