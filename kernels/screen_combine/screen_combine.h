// Joint bilateral up-sampling (Kopf et al. 2007) from a level of the pyramid: 3 x 3 texels around a pixel, weighted by
// the quadratic B-spline of their distance to its centre (which reproduces linear functions: no level is shifted
// against another), nothing across a depth or normal edge. The program defines LW_INTERLEAVE: pixels per texel along
// each axis, 1, 2 or 4.
#ifndef LW_SCREEN_COMBINE_H
#define LW_SCREEN_COMBINE_H

#include "shared/edge_weight.h"
#include "shared/interleave.h"
#include "shared/screen_types.h"
#include "shared/surface.h"

// Light summed by weight; a pixel of an image whose texels are LW_INTERLEAVE pixels wide.
typedef struct { real v[LW_LIGHT_PLANES], weight; } lw_light_sum;

// A pyramid's texels and their light, LW_WIDTH side by side.
typedef struct { lw_surface s; real v[LW_LIGHT_PLANES]; } lw_lit_texel;

// Texels from column x on; rows have borders without a surface.
LW_FN lw_lit_texel load_lit(__global const float* texels, int4 texelLayout, __global const float* light, int4 lightLayout,
                            int x, int y) {
    lw_lit_texel t;
    const int at = texelLayout.x + y * texelLayout.y + x, from = lightLayout.x + y * lightLayout.y + x;
    t.s.px = load(texels, at);
    t.s.py = load(texels, at + texelLayout.z);
    t.s.pz = load(texels, at + 2 * texelLayout.z);
    t.s.nx = load(texels, at + 3 * texelLayout.z);
    t.s.ny = load(texels, at + 4 * texelLayout.z);
    t.s.nz = load(texels, at + 5 * texelLayout.z);
    t.s.valid = squared_length(t.s.nx, t.s.ny, t.s.nz) > 0.25f;
    for (int a = 0; a < LW_LIGHT_PLANES; ++a) t.v[a] = load(light, from + a * lightLayout.z);
    return t;
}

LW_FN void add_lit(lw_light_sum* sum, real w, const lw_lit_texel t) {
    for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] = fma_(w, t.v[a], sum->v[a]);
    sum->weight += w;
}

// Weight of the texel `tap` (-1, 0, 1) away for pixel number `phase` of a texel.
LW_FN float spline_weight(int tap, int phase) {
    const float d = ((float)phase + 0.5f) * (1.0f / LW_INTERLEAVE) - 0.5f;
    if (tap == 0) return 0.75f - d * d;
    const float t = 0.5f + (tap < 0 ? -d : d);
    return 0.5f * t * t;
}

// The light of pixels x = LW_INTERLEAVE * hx + phase + .. of row y, from texels hx ..: sum[phase], to be divided by its
// weight. `lit` by likeness of normals alone instead of the edge test: for pixels that no texel passes it for.
LW_FN void gather_texels(lw_light_sum* sum, const lw_surface* s, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, const int byLikeness) {
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum[phase].v[a] = (real)0.0f;
        sum[phase].weight = (real)0.0f;
    }
    for (int j = -1; j <= 1; ++j) {
        const int hy = y / LW_INTERLEAVE + j;
        if (hy < 0 || hy >= texelRows) continue;
        const float rowWeight = spline_weight(j, y % LW_INTERLEAVE);
        for (int i = -1; i <= 1; ++i) {
            const lw_lit_texel t = load_lit(texels, texelLayout, light, lightLayout, hx + i, hy);
            LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
                const float tent = rowWeight * spline_weight(i, phase);
                real w;
                if (byLikeness) {
                    const real alike = fma_(t.s.nx, s[phase].nx, fma_(t.s.ny, s[phase].ny, t.s.nz * s[phase].nz));
                    w = select_((real)0.0f, (fmax(alike, (real)0.0f) + 1e-3f) * tent, t.s.valid);
                } else {
                    w = tent * edge_weight(s[phase], t.s.px, t.s.py, t.s.pz, t.s.nx, t.s.ny, t.s.nz, (real)1.0f);
                }
                add_lit(&sum[phase], w, t);
            }
        }
    }
}

// A weight this far below a texel's own comes from rounding at the edge tests' borders.
#define LW_LOST_WEIGHT 1e-4f

// What gather_texels finds, divided; surfaces that no texel of their own reaches are lit by likeness of normals.
// Returns how many of the first `width` columns those are.
LW_FN int upsample_light(lw_light_sum* sum, const lw_surface* s, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, int width) {
    gather_texels(sum, s, texels, texelLayout, light, lightLayout, hx, y, texelRows, 0);
    mask lost[LW_INTERLEAVE], some = splat_mask(0);
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        lost[phase] = and_(s[phase].valid, not_(sum[phase].weight > LW_LOST_WEIGHT));
        some = or_(some, lost[phase]);
    }
    int count = 0;
    if (any_(some)) {
        lw_light_sum rest[LW_INTERLEAVE];
        gather_texels(rest, s, texels, texelLayout, light, lightLayout, hx, y, texelRows, 1);
        LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
            for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum[phase].v[a] = select_(sum[phase].v[a], rest[phase].v[a], lost[phase]);
            sum[phase].weight = select_(sum[phase].weight, rest[phase].weight, lost[phase]);
            const lanei column = (lanei_iota() + (lanei)hx) * LW_INTERLEAVE + (lanei)phase;
            count += count_(and_(lost[phase], column < (lanei)width));
        }
    }
    LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) {
        const real scale = select_((real)0.0f, 1.0f / sum[phase].weight, and_(s[phase].valid, sum[phase].weight > 0.0f));
        for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum[phase].v[a] *= scale;
    }
    return count;
}

#endif
