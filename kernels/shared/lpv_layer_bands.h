// Light at points from nested grids, in two bands of spherical harmonics, each grid as lpv_layers.h has it.
#ifndef LW_LPV_LAYER_BANDS_H
#define LW_LPV_LAYER_BANDS_H

#include "lpv_layers.h"
#include "points.h"

// Writes what points have after this grid, as store_bands does. True lanes of the result: of what no finer grid goes over, as
// store_bands', and what is blended from a coarser grid's that has been brought down.
LW_FN mask store_layer(const lpv_layer own, int isCoarsest, lw_bands light, __global float* harmonics, int4 layout, int band, int x,
                       int y) {
    if (isCoarsest) return and_(store_bands(light, own.read, harmonics, layout, band, x, y), own.isLast);
    mask cut = splat_mask(0);
    for (int b = 0; b < 4; ++b)
        for (int c = 0; c < 3; ++c) {
            const real coarser = load(harmonics, layout.x + y * layout.y + x + b * band + c * layout.z);
            cut = or_(cut, and_(fabs(coarser) >= (real)LW_LARGEST_IRRADIANCE, own.share < 1.0f));
            light.c[b][c] = layered(own, coarser, light.c[b][c]);
        }
    return and_(or_(store_bands(light, splat_mask(1), harmonics, layout, band, x, y), and_(cut, own.read)), own.isLast);
}

#endif
