// What kernels ask of an RSM's texels by their place in the map.
#ifndef LW_RSM_TEXEL_H
#define LW_RSM_TEXEL_H

#include "rsm_types.h"
#include "wide.h"

LW_FN real rsm_linear(float4 c, real i, real j) { return fma_(c.x, i, fma_(c.y, j, c.w)); }

// Whether texels whose centres are (i, j) lie within a finer cascade.
LW_FN mask rsm_covered(const LwRsmSpan span, real i, real j) {
    mask covered = splat_mask(0);
    for (int c = 0; c < span.finerCount; ++c) {
        const real cx = rsm_linear(span.finer[2 * c], i, j), cy = rsm_linear(span.finer[2 * c + 1], i, j);
        covered = or_(covered, and_(fabs(cx) <= 1.0f, fabs(cy) <= 1.0f));
    }
    return covered;
}

#endif
