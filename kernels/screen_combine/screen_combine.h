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

// Structs are handed on by pointer: by value, PoCL copies them through memory, tap by tap.

// Light summed by weight.
typedef struct { real v[LW_LIGHT_PLANES], weight; } lw_light_sum;

// A pyramid's texels and their light, LW_WIDTH side by side.
typedef struct { real px, py, pz, nx, ny, nz, v[LW_LIGHT_PLANES]; } lw_lit_texel;

// A row of texels and their light, from some column on. Kept as one pointer a plane, so that a row's taps differ by a
// constant: as indices of one pointer each load would take its own sum and sign extension, more work than the tap's.
typedef struct {
    __global const float *surface[6], *light[LW_LIGHT_PLANES];
} lw_lit_row;

LW_FN void lit_row(lw_lit_row* row, __global const float* texels, int4 texelLayout, __global const float* light,
                   int4 lightLayout, int x, int y) {
    row->surface[0] = texels + (texelLayout.x + y * texelLayout.y + x);
    row->light[0] = light + (lightLayout.x + y * lightLayout.y + x);
    LW_UNROLL for (int a = 1; a < 6; ++a) row->surface[a] = row->surface[a - 1] + texelLayout.z;
    LW_UNROLL for (int a = 1; a < LW_LIGHT_PLANES; ++a) row->light[a] = row->light[a - 1] + lightLayout.z;
}

// Texels i columns on; rows have borders without a surface.
LW_FN void load_lit(lw_lit_texel* t, const lw_lit_row* row, int i) {
    t->px = load(row->surface[0], i);
    t->py = load(row->surface[1], i);
    t->pz = load(row->surface[2], i);
    t->nx = load(row->surface[3], i);
    t->ny = load(row->surface[4], i);
    t->nz = load(row->surface[5], i);
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) t->v[a] = load(row->light[a], i);
}

// Weight of a texel for a surface: nothing across an edge, nothing of a texel without a surface (its normal is zero).
LW_FN real lit_weight(const lw_edges* e, const lw_lit_texel* t) {
    return edge_weight(*e, t->px, t->py, t->pz, t->nx, t->ny, t->nz);
}

LW_FN void clear_sum(lw_light_sum* sum) {
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] = (real)0.0f;
    sum->weight = (real)0.0f;
}

LW_FN void add_lit(lw_light_sum* sum, real w, const lw_lit_texel* t) {
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] = fma_(w, t->v[a], sum->v[a]);
    sum->weight += w;
}

// Weight of the texel `tap` (-1, 0, 1) away for pixel number `phase` of a texel.
LW_FN float spline_weight(int tap, int phase) {
    const float d = ((float)phase + 0.5f) * (1.0f / LW_INTERLEAVE) - 0.5f;
    if (tap == 0) return 0.75f - d * d;
    const float t = 0.5f + (tap < 0 ? -d : d);
    return 0.5f * t * t;
}

// The light of pixels LW_INTERLEAVE * hx + phase, .. of row y, to be divided by its weight. byLikeness, a constant: by
// likeness of normals alone instead of the edge test, for pixels that no texel passes it for.
LW_FN void gather_texels(lw_light_sum* sum, const lw_surface* s, int phase, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, const int byLikeness) {
    const lw_edges edges = edges_of(*s, (real)1.0f);
    clear_sum(sum);
    for (int j = -1; j <= 1; ++j) {
        const int hy = y / LW_INTERLEAVE + j;
        if (hy < 0 || hy >= texelRows) continue;
        const float rowWeight = spline_weight(j, y % LW_INTERLEAVE);
        lw_lit_row row;
        lit_row(&row, texels, texelLayout, light, lightLayout, hx, hy);
        LW_UNROLL for (int i = -1; i <= 1; ++i) {
            lw_lit_texel t;
            load_lit(&t, &row, i);
            const float tent = rowWeight * spline_weight(i, phase);
            real w;
            if (byLikeness) {
                const real alike = fma_(t.nx, s->nx, fma_(t.ny, s->ny, t.nz * s->nz));
                w = select_((real)0.0f, (fmax(alike, (real)0.0f) + 1e-3f) * tent, squared_length(t.nx, t.ny, t.nz) > 0.25f);
            } else {
                w = tent * lit_weight(&edges, &t);
            }
            add_lit(sum, w, &t);
        }
    }
}

// A weight this far below a texel's own comes from rounding at the edge tests' borders.
#define LW_LOST_WEIGHT 1e-4f

// What gather_texels finds, divided; surfaces that no texel of their own reaches are lit by likeness of normals.
// Returns how many of the first `width` columns those are.
LW_FN int upsample_light(lw_light_sum* sum, const lw_surface* s, int phase, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, int width) {
    gather_texels(sum, s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, 0);
    const mask lost = and_(s->valid, not_(sum->weight > LW_LOST_WEIGHT));
    int count = 0;
    if (any_(lost)) {
        lw_light_sum rest;
        gather_texels(&rest, s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, 1);
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] = select_(sum->v[a], rest.v[a], lost);
        sum->weight = select_(sum->weight, rest.weight, lost);
        const lanei column = (lanei_iota() + (lanei)hx) * LW_INTERLEAVE + (lanei)phase;
        count = count_(and_(lost, column < (lanei)width));
    }
    const real scale = select_((real)0.0f, 1.0f / sum->weight, and_(s->valid, sum->weight > 0.0f));
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] *= scale;
    return count;
}

#endif
