// The light of the pyramid's levels put together, coarse to fine, and into a host's image (Soler et al. 2009,
// section 3.2: "added into a buffer, up-sampled to the size of the next mipmap").
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 2  // pixels of the finer image per texel: 2 between levels; 1, 2, 4 into the host's image
#endif
#include "shared/wide.h"
#include "screen_combine.h"

// One work-item = LW_INTERLEAVE * LW_WIDTH texels of one row of the finer level: its own light and that of all
// coarser ones. width, height: of the finer level.
__kernel void screen_combine_add(__global const float* fine, int4 fineLayout, int width, int height,
                                 __global const float* own, int4 ownLayout, __global const float* coarse, int4 coarseLayout,
                                 int coarseRows, __global const float* light, int4 lightLayout, __global float* sum,
                                 int4 sumLayout) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1), x = hx * LW_INTERLEAVE;
    if (x >= width || y >= height) return;
    real p[6][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 6; ++a) load_dealt(p[a], fine, fineLayout.x + a * fineLayout.z + y * fineLayout.y, x, width);
    real up[LW_LIGHT_PLANES][LW_INTERLEAVE];
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        const lw_surface s = make_surface(p[0][phase], p[1][phase], p[2][phase], p[3][phase], p[4][phase], p[5][phase]);
        lw_light_sum found;
        upsample_light(&found, &s, phase, coarse, coarseLayout, light, lightLayout, hx, y, coarseRows, width);
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) up[a][phase] = found.v[a];
    }
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) {
        real v[LW_INTERLEAVE];
        load_dealt(v, own, ownLayout.x + a * ownLayout.z + y * ownLayout.y, x, width);
        LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) v[phase] += up[a][phase];
        store_dealt(v, sum, sumLayout.x + a * sumLayout.z + y * sumLayout.y, x, width);
    }
}

// One work-item = LW_INTERLEAVE * LW_WIDTH pixels of one row of the host's image. hasValidity, hasIrradiance: which
// outputs there are. Validity: the share of the hemisphere that the samples fill, at most 1.
__kernel void screen_combine_finish(__global const float* position, int4 positionLayout, __global const float* normal,
                                    int4 normalLayout, int width, int height, __global const float* texels, int4 texelLayout,
                                    int texelRows, __global const float* light, int4 lightLayout, int hasIrradiance,
                                    __global float* irradiance, int4 irradianceLayout, int hasValidity,
                                    __global float* validity, int4 validityLayout, __global int* counts) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1), x = hx * LW_INTERLEAVE;
    if (x >= width || y >= height) return;
    real p[6][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_dealt(p[a], position, positionLayout.x + a * positionLayout.z + y * positionLayout.y, x, width);
        load_dealt(p[3 + a], normal, normalLayout.x + a * normalLayout.z + y * normalLayout.y, x, width);
    }
    real out[LW_LIGHT_PLANES][LW_INTERLEAVE];
    int lost = 0, saturated = 0;
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        const lw_surface s = make_surface(p[0][phase], p[1][phase], p[2][phase], p[3][phase], p[4][phase], p[5][phase]);
        lw_light_sum found;
#if LW_INTERLEAVE == 1
        lw_lit_row row;
        lw_lit_texel t;
        lit_row(&row, texels, texelLayout, light, lightLayout, x, y);
        load_lit(&t, &row, 0);
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) found.v[a] = select_((real)0.0f, t.v[a], s.valid);
#else
        lost += upsample_light(&found, &s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, width);
#endif
        // Levels are already at the limit where they were above it.
        const real most = (real)LW_LARGEST_IRRADIANCE;
        const mask full = fmax(found.v[0], fmax(found.v[1], found.v[2])) >= most;
        if (any_(full)) saturated += count_(full);
        LW_UNROLL for (int a = 0; a < 3; ++a) out[a][phase] = fmin(found.v[a], most);
        out[LW_LIGHT_SHARE][phase] = fmin(found.v[LW_LIGHT_SHARE], (real)1.0f);
    }
    if (lost) atomic_add(counts + LW_SCREEN_FALLBACKS, lost);
    if (saturated) atomic_add(counts + LW_SCREEN_SATURATED, saturated);
    if (hasIrradiance) {
        LW_UNROLL for (int a = 0; a < 3; ++a)
            store_dealt(out[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
    }
    if (hasValidity) store_dealt(out[LW_LIGHT_SHARE], validity, validityLayout.x + y * validityLayout.y, x, width);
}
