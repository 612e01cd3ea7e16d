// The light of the pyramid's levels put together, coarse to fine, and into a host's image (Soler et al. 2009,
// section 3.2: "added into a buffer, up-sampled to the size of the next mipmap").
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 2  // pixels of the finer image per texel: 2 between levels; 1, 2, 4 into the host's image
#endif
#include "shared/wide.h"
#include "screen_combine.h"

// One work-item = LW_INTERLEAVE * LW_WIDTH texels of two rows of the finer level: its own light and that of all
// coarser ones. width, height: of the finer level.
__kernel void screen_combine_add(__global const float* fine, int4 fineLayout, int width, int height,
                                 __global const float* own, int4 ownLayout, __global const float* coarse, int4 coarseLayout,
                                 int coarseRows, __global const float* light, int4 lightLayout, __global float* sum,
                                 int4 sumLayout) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1) * LW_LIT_ROWS, x = hx * LW_INTERLEAVE;
    if (x >= width || y >= height) return;
    const int rows = min(LW_LIT_ROWS, height - y), whole = x + LW_INTERLEAVE * LW_WIDTH <= width;
    real p[LW_LIT_ROWS][6][LW_INTERLEAVE], up[LW_LIT_ROWS][LW_LIGHT_PLANES][LW_INTERLEAVE];
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k)
        LW_UNROLL for (int a = 0; a < 6; ++a)
            load_phases(p[k][a], fine, fineLayout.x + a * fineLayout.z + min(y + k, height - 1) * fineLayout.y, x, width, whole);
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        lw_surface s[LW_LIT_ROWS];
        lw_light_sum found[LW_LIT_ROWS];
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k)
            s[k] = make_surface(p[k][0][phase], p[k][1][phase], p[k][2][phase], p[k][3][phase], p[k][4][phase], p[k][5][phase]);
        upsample_light(found, s, phase, coarse, coarseLayout, light, lightLayout, hx, y, coarseRows, width, rows);
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k)
            LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) up[k][a][phase] = found[k].v[a];
    }
    for (int k = 0; k < rows; ++k)
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) {
            real v[LW_INTERLEAVE];
            load_phases(v, own, ownLayout.x + a * ownLayout.z + (y + k) * ownLayout.y, x, width, whole);
            LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) v[phase] += up[k][a][phase];
            store_phases(v, sum, sumLayout.x + a * sumLayout.z + (y + k) * sumLayout.y, x, width, whole);
        }
}

// One work-item = LW_INTERLEAVE * LW_WIDTH pixels of two rows of the host's image. hasValidity, hasIrradiance: which
// outputs there are. Validity: the share of the hemisphere that the samples fill, at most 1.
__kernel void screen_combine_finish(__global const float* position, int4 positionLayout, __global const float* normal,
                                    int4 normalLayout, int width, int height, __global const float* texels, int4 texelLayout,
                                    int texelRows, __global const float* light, int4 lightLayout, int hasIrradiance,
                                    __global float* irradiance, int4 irradianceLayout, int hasValidity,
                                    __global float* validity, int4 validityLayout, __global int* counts) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1) * LW_LIT_ROWS, x = hx * LW_INTERLEAVE;
    if (x >= width || y >= height) return;
    const int rows = min(LW_LIT_ROWS, height - y), whole = x + LW_INTERLEAVE * LW_WIDTH <= width;
    real p[LW_LIT_ROWS][6][LW_INTERLEAVE], out[LW_LIT_ROWS][LW_LIGHT_PLANES][LW_INTERLEAVE];
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
        const int row = min(y + k, height - 1);
        LW_UNROLL for (int a = 0; a < 3; ++a) {
            load_phases(p[k][a], position, positionLayout.x + a * positionLayout.z + row * positionLayout.y, x, width, whole);
            load_phases(p[k][3 + a], normal, normalLayout.x + a * normalLayout.z + row * normalLayout.y, x, width, whole);
        }
    }
    // What the next work-item reads: without, it waits for memory first.
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k)
        LW_UNROLL for (int a = 0; a < 3; ++a)
            LW_UNROLL for (int j = LW_INTERLEAVE; j < 2 * LW_INTERLEAVE; ++j) {
                will_load(position + positionLayout.x + a * positionLayout.z + min(y + k, height - 1) * positionLayout.y + x + j * LW_WIDTH);
                will_load(normal + normalLayout.x + a * normalLayout.z + min(y + k, height - 1) * normalLayout.y + x + j * LW_WIDTH);
            }
    int lost = 0, saturated = 0;
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        lw_surface s[LW_LIT_ROWS];
        lw_light_sum found[LW_LIT_ROWS];
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k)
            s[k] = make_surface(p[k][0][phase], p[k][1][phase], p[k][2][phase], p[k][3][phase], p[k][4][phase], p[k][5][phase]);
#if LW_INTERLEAVE == 1
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
            lw_lit_row row;
            lw_lit_texel t;
            lit_row(&row, texels, texelLayout, light, lightLayout, x, min(y + k, height - 1));
            load_lit(&t, &row, 0);
            LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) found[k].v[a] = select_((real)0.0f, t.v[a], s[k].valid);
        }
#else
        lost += upsample_light(found, s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, width, rows);
#endif
        // Levels are already at the limit where they were above it.
        const real most = (real)LW_LARGEST_IRRADIANCE;
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
            const mask full = fmax(found[k].v[0], fmax(found[k].v[1], found[k].v[2])) >= most;
            if (k < rows && any_(full)) saturated += count_(full);
            LW_UNROLL for (int a = 0; a < 3; ++a) out[k][a][phase] = fmin(found[k].v[a], most);
            out[k][LW_LIGHT_SHARE][phase] = fmin(found[k].v[LW_LIGHT_SHARE], (real)1.0f);
        }
    }
    if (lost) atomic_add(counts + LW_SCREEN_FALLBACKS, lost);
    if (saturated) atomic_add(counts + LW_SCREEN_SATURATED, saturated);
    for (int k = 0; k < rows; ++k) {
        if (hasIrradiance) {
            LW_UNROLL for (int a = 0; a < 3; ++a)
                store_phases(out[k][a], irradiance, irradianceLayout.x + a * irradianceLayout.z + (y + k) * irradianceLayout.y, x, width, whole);
        }
        if (hasValidity) store_phases(out[k][LW_LIGHT_SHARE], validity, validityLayout.x + (y + k) * validityLayout.y, x, width, whole);
    }
}
