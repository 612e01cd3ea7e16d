// Nested grids: what of a pixel's light each of them gives. Grids are numbered from the finest one on, and read from the coarsest one
// on, each in a launch of its own that goes over what the coarser ones have written:
//   E = E_coarser + (1 - a) (E_own - E_coarser),  a = clamp(max over axes of (|P - C| - (half - w)) / w, 0, 1).
// Even light, the same in all grids, is the same to the bit everywhere.
#ifndef LW_LPV_LAYERS_H
#define LW_LPV_LAYERS_H

#include "lpv_types.h"
#include "wide.h"

// w, as a share of the grid's side. Less: a seam where cells double. More: less of the fine grid is of use.
#define LPV_BLEND 0.1f

// a of grids of `size` cells: 0 where the grid has all of a place's light, 1 outside of it.
LW_FN real lpv_coarser(const LwLpvPlace place, int size, real px, real py, real pz) {
    const float half_ = 0.5f * (float)size, inner = (0.5f - LPV_BLEND) * (float)size, scale = 1.0f / (LPV_BLEND * (float)size);
    const real x = fabs((px - place.origin.x) * place.origin.w - half_), y = fabs((py - place.origin.y) * place.origin.w - half_),
               z = fabs((pz - place.origin.z) * place.origin.w - half_);
    return clamp((fmax(fmax(x, y), z) - inner) * scale, (real)0.0f, (real)1.0f);
}

typedef struct {
    real share;   // 1 - a; of the coarsest one 1
    mask read;    // of what has a share of this grid's light that no finer one replaces: what there is to read
    mask isLast;  // no finer grid comes after this one
} lpv_layer;

// has: surfaces that the coarsest grid has, where this is the coarsest; surfaces, where not.
LW_FN lpv_layer layer_of(__global const LwLpvPlace* grids, int layer, int layers, int size, real px, real py, real pz, mask has) {
    lpv_layer l;
    l.share = layer + 1 < layers ? 1.0f - lpv_coarser(grids[layer], size, px, py, pz) : (real)1.0f;
    l.read = and_(has, l.share > 0.0f);
    l.isLast = splat_mask(1);
    for (int finer = 0; finer < layer; ++finer) {
        const real a = lpv_coarser(grids[finer], size, px, py, pz);
        l.read = and_(l.read, a > 0.0f);
        l.isLast = and_(l.isLast, a >= 1.0f);
    }
    return l;
}

// What a pixel has after this grid: `own` light in place of the `coarser` ones'.
LW_FN real layered(const lpv_layer l, real coarser, real own) {
    const real blended = select_(fma_(l.share, own - coarser, coarser), own, l.share >= 1.0f);
    return select_(coarser, blended, l.read);
}

#endif
