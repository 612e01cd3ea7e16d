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

// A surface as its texels are measured by it: its place, and its normal over the slope of the edge test.
typedef struct { real px, py, pz, tx, ty, tz; } lw_lit_edges;

LW_FN lw_lit_edges lit_edges(const lw_surface* s) {
    const float over = 1.0f / LW_EDGE_SLOPE;
    const lw_lit_edges e = {s->px, s->py, s->pz, s->nx * over, s->ny * over, s->nz * over};
    return e;
}

// What lit_weight is of edge_weight (shared/edge_weight.h): with the normal divided by the slope neither the slope nor the range
// of the cosine needs a product of its own. Sums of weights are divided by each other, so that the factor drops out.
#define LW_LIT_SCALE ((1.0f - LW_EDGE_NORMAL_COSINE) / LW_EDGE_SLOPE)

// `tent` times the weight of a texel for a surface: nothing across an edge, nothing of a texel without a surface (its normal is zero). Both
// normals are of unit length, so that there is no need to hold the weight of equal ones at LW_LIT_SCALE but for rounding.
LW_FN real lit_weight(const lw_lit_edges* e, const lw_lit_texel* t, float tent) {
    const real dx = t->px - e->px, dy = t->py - e->py, dz = t->pz - e->pz;
    const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
    const real off = fma_(dx, e->tx, fma_(dy, e->ty, dz * e->tz));
    const real w = fma_(t->nx, e->tx, fma_(t->ny, e->ty, fma_(t->nz, e->tz, -LW_EDGE_NORMAL_COSINE / LW_EDGE_SLOPE)));
    return select_((real)0.0f, w * tent, and_(off * off <= d2, w > 0.0f));
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

// Rows of the finer image that a work-item takes together: they share their texels. 2 divides LW_INTERLEAVE.
#define LW_LIT_ROWS 2

// The light of pixels LW_INTERLEAVE * hx + phase, .. of rows y, y + 1, to be divided by its weight. byLikeness, a constant: by
// likeness of normals alone instead of the edge test, for pixels that no texel passes it for.
LW_FN void gather_texels(lw_light_sum* sums, const lw_surface* s, int phase, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, const int byLikeness) {
    lw_lit_edges edges[LW_LIT_ROWS];
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
        edges[k] = lit_edges(&s[k]);
        clear_sum(&sums[k]);
    }
    for (int j = -1; j <= 1; ++j) {
        const int hy = y / LW_INTERLEAVE + j;
        if (hy < 0 || hy >= texelRows) continue;
        const float rowWeight[LW_LIT_ROWS] = {spline_weight(j, y % LW_INTERLEAVE), spline_weight(j, y % LW_INTERLEAVE + 1)};
        lw_lit_row row;
        lit_row(&row, texels, texelLayout, light, lightLayout, hx, hy);
        LW_UNROLL for (int i = -1; i <= 1; ++i) {
            lw_lit_texel t;
            load_lit(&t, &row, i);
            LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
                const float tent = rowWeight[k] * spline_weight(i, phase);
                real w;
                if (byLikeness) {
                    const real alike = fma_(t.nx, s[k].nx, fma_(t.ny, s[k].ny, t.nz * s[k].nz));
                    w = select_((real)0.0f, (fmax(alike, (real)0.0f) + 1e-3f) * tent, squared_length(t.nx, t.ny, t.nz) > 0.25f);
                } else {
                    w = lit_weight(&edges[k], &t, tent);
                }
                add_lit(&sums[k], w, &t);
            }
        }
    }
}

// A weight this far below a texel's own comes from rounding at the edge tests' borders.
#define LW_LOST_WEIGHT (1e-4f * LW_LIT_SCALE)

// What gather_texels finds, divided; surfaces that no texel of their own reaches are lit by likeness of normals.
// Returns how many of the first `width` columns of the first `rows` rows those are.
LW_FN int upsample_light(lw_light_sum* sums, const lw_surface* s, int phase, __global const float* texels, int4 texelLayout,
                         __global const float* light, int4 lightLayout, int hx, int y, int texelRows, int width, int rows) {
    gather_texels(sums, s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, 0);
    mask lost[LW_LIT_ROWS], some = splat_mask(0);
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
        lost[k] = and_(s[k].valid, not_(sums[k].weight > LW_LOST_WEIGHT));
        some = or_(some, lost[k]);
    }
    int count = 0;
    if (any_(some)) {
        lw_light_sum rest[LW_LIT_ROWS];
        gather_texels(rest, s, phase, texels, texelLayout, light, lightLayout, hx, y, texelRows, 1);
        const lanei column = (lanei_iota() + (lanei)hx) * LW_INTERLEAVE + (lanei)phase;
        LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
            LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sums[k].v[a] = select_(sums[k].v[a], rest[k].v[a], lost[k]);
            sums[k].weight = select_(sums[k].weight, rest[k].weight, lost[k]);
            if (k < rows) count += count_(and_(lost[k], column < (lanei)width));
        }
    }
    LW_UNROLL for (int k = 0; k < LW_LIT_ROWS; ++k) {
        const real scale = select_((real)0.0f, 1.0f / sums[k].weight, and_(s[k].valid, sums[k].weight > 0.0f));
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) sums[k].v[a] *= scale;
    }
    return count;
}

// load_dealt and store_dealt without tests of the columns where the whole of a work-item lies in the image.
LW_FN void load_phases(real* v, __global const float* plane, int row, int x, int width, int whole) {
    if (whole) {
        LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) v[j] = load_whole(plane + row + x + j * LW_WIDTH);
        deal_(v);
    } else {
        load_dealt(v, plane, row, x, width);
    }
}

LW_FN void store_phases(real* v, __global float* plane, int row, int x, int width, int whole) {
    if (whole) {
        undeal_(v);
        LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) store(v[j], plane, row + x + j * LW_WIDTH);
    } else {
        store_dealt(v, plane, row, x, width);
    }
}

#endif
