// Half resolution and back: a G-buffer of every second column and row, and joint bilateral up-sampling
// (Kopf et al. 2007) of what was computed on it: 3x3 half-resolution samples around a pixel, a tent in
// the distance of pixels, nothing across a depth or normal edge.
// Over 300 lines: up-sampling that marks pixels is the same loops, compiled in.
#ifndef LW_CHANNELS
#define LW_CHANNELS 3  // of the light: 1 a scalar, 3 irradiance, 5 irradiance and two scalars
#endif
#ifndef LW_MARKS
#define LW_MARKS 0  // 1: up-sampling marks the pixels that it does not know the light of; of irradiance only
#endif
#include "shared/pixel_repair_types.h"
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_slope.h"
#include "shared/edge_weight.h"
#include "shared/neighbours.h"

// The columns 2x and 2x + 1 of LW_WIDTH blocks of two: the even and odd ones of two vectors.
typedef struct { real even, odd; } lw_pair;

LW_FN lw_pair load_pair(__global const float* image, int row, int x, int rowEnd) {
    const real a = load_whole(image + row + x);
    const real b = x + LW_WIDTH < rowEnd ? load_whole(image + row + x + LW_WIDTH) : (real)0.0f;
    const lw_pair pair = {even_(a, b), odd_(a, b)};
    return pair;
}

LW_FN void store_pair(__global float* plane, int at, int hasSecond, real even, real odd) {
    store_past(zip_lo_(even, odd), plane, at);
    if (hasSecond) store_past(zip_hi_(even, odd), plane, at + LW_WIDTH);
}

// odd: a constant.
LW_FN lw_surface surface_of(const lw_pair* p, const lw_pair* n, int odd) {
    return odd ? make_surface(p[0].odd, p[1].odd, p[2].odd, n[0].odd, n[1].odd, n[2].odd)
               : make_surface(p[0].even, p[1].even, p[2].even, n[0].even, n[1].even, n[2].even);
}

LW_FN void prefer(lw_surface* chosen, const lw_surface other, mask inside) {
    const mask take = and_(not_(chosen->valid), and_(other.valid, inside));
    chosen->px = select_(chosen->px, other.px, take);
    chosen->py = select_(chosen->py, other.py, take);
    chosen->pz = select_(chosen->pz, other.pz, take);
    chosen->nx = select_(chosen->nx, other.nx, take);
    chosen->ny = select_(chosen->ny, other.ny, take);
    chosen->nz = select_(chosen->nz, other.nz, take);
    chosen->valid = or_(chosen->valid, take);
}

LW_FN void load_pairs(lw_pair* p, lw_pair* n, __global const float* position, int4 positionLayout, __global const float* normal,
                      int4 normalLayout, int x, int y, int rowEnd) {
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        p[a] = load_pair(position, positionLayout.x + a * positionLayout.z + y * positionLayout.y, x, rowEnd);
        n[a] = load_pair(normal, normalLayout.x + a * normalLayout.z + y * normalLayout.y, x, rowEnd);
    }
}

// One work-item = LW_WIDTH half-resolution pixels: the first valid surface of each 2x2 block, in the
// fixed order top left, bottom right, top right, bottom left. half*: 3 planes each.
__kernel void joint_bilateral_downsample(__global const float* position, int4 positionLayout,
                                         __global const float* normal, int4 normalLayout, int width, int height,
                                         __global float* halfPosition, int4 halfPositionLayout,
                                         __global float* halfNormal, int4 halfNormalLayout) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, hy = (int)get_global_id(1);
    const int halfWidth = (width + 1) / 2, halfHeight = (height + 1) / 2;
    if (hx >= halfWidth || hy >= halfHeight) return;
    const int rowEnd = (width + 15) & ~15;
    const lanei column = lanei_iota() * 2 + (lanei)(2 * hx);
    const mask evenInside = column < (lanei)width, oddInside = column + 1 < (lanei)width;

    lw_pair p[3], n[3];
    load_pairs(p, n, position, positionLayout, normal, normalLayout, 2 * hx, 2 * hy, rowEnd);
    lw_surface s = surface_of(p, n, 0);
    s.valid = and_(s.valid, evenInside);
    // The second row only where the first one's left pixels do not do: seldom, and it is half of what there is to read.
    if (any_(and_(not_(s.valid), evenInside))) {
        const lw_surface right = surface_of(p, n, 1);
        load_pairs(p, n, position, positionLayout, normal, normalLayout, 2 * hx, min(2 * hy + 1, height - 1), rowEnd);
        prefer(&s, surface_of(p, n, 1), oddInside);
        prefer(&s, right, oddInside);
        prefer(&s, surface_of(p, n, 0), evenInside);
    }

    const real zero = (real)0.0f;
    const int po = halfPositionLayout.x + hy * halfPositionLayout.y + hx;
    const int no = halfNormalLayout.x + hy * halfNormalLayout.y + hx;
    store(select_(zero, s.px, s.valid), halfPosition, po);
    store(select_(zero, s.py, s.valid), halfPosition, po + halfPositionLayout.z);
    store(select_(zero, s.pz, s.valid), halfPosition, po + 2 * halfPositionLayout.z);
    store(select_(zero, s.nx, s.valid), halfNormal, no);
    store(select_(zero, s.ny, s.valid), halfNormal, no + halfNormalLayout.z);
    store(select_(zero, s.nz, s.valid), halfNormal, no + 2 * halfNormalLayout.z);
}

// The half-resolution images: surfaces that down-sampling made, and the light on them.
typedef struct {
    __global const float *position, *normal, *light;
    int4 positionLayout, normalLayout, lightLayout;
    int width, height;
} lw_coarse;

typedef struct { real px, py, pz, nx, ny, nz, light[LW_CHANNELS]; mask valid; } lw_sample;

// The samples i columns beside LW_WIDTH blocks, of row hy; those that do not exist are not valid, and dark.
LW_FN void load_sample(lw_sample* q, const lw_coarse* coarse, int hx, int i, int hy) {
#define LW_TAP(image, layout, a) load_beside(image, layout.x + (a) * layout.z + hy * layout.y, hx, i, coarse->width)
    q->px = LW_TAP(coarse->position, coarse->positionLayout, 0);
    q->py = LW_TAP(coarse->position, coarse->positionLayout, 1);
    q->pz = LW_TAP(coarse->position, coarse->positionLayout, 2);
    q->nx = LW_TAP(coarse->normal, coarse->normalLayout, 0);  // unit or zero: down-sampling saw to it
    q->ny = LW_TAP(coarse->normal, coarse->normalLayout, 1);
    q->nz = LW_TAP(coarse->normal, coarse->normalLayout, 2);
    const lanei column = lanei_iota() + (lanei)(hx + i);
    const mask exists = and_(column >= (lanei)0, column < (lanei)coarse->width);
    q->valid = and_(exists, fma_(q->nx, q->nx, fma_(q->ny, q->ny, q->nz * q->nz)) > 0.5f);
    LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a)
        q->light[a] = select_((real)0.0f, LW_TAP(coarse->light, coarse->lightLayout, a), exists);
#undef LW_TAP
}

typedef struct {
    real light[LW_CHANNELS], weight;
#if LW_MARKS
    real least, greatest;  // of the samples' sums of red, green and blue
#endif
} lw_sum;

LW_FN void accumulate(lw_sum* sum, real w, const real* light) {
    LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a) sum->light[a] = fma_(w, light[a], sum->light[a]);
    sum->weight += w;
}

#if LW_MARKS
// Of what counts. Light is no NaN.
LW_FN void widen(lw_sum* sum, real w, const real* light) {
    const real whole = (light[0] + light[1]) + light[2];
    const mask counts = w > 0.0f;
    const real low = select_((real)INFINITY, whole, counts), high = select_((real)0.0f, whole, counts);
    sum->least = select_(sum->least, low, low < sum->least);
    sum->greatest = select_(sum->greatest, high, high > sum->greatest);
}

// Where samples on the pixel's surface differ by more than `share` of what comes of them all.
LW_FN mask is_steep(const lw_sum* sum, float share) {
    const real whole = (sum->light[0] + sum->light[1]) + sum->light[2];
    return (sum->greatest - sum->least) * sum->weight > share * whole;
}

// A word's low half with a bit's room after each bit.
LW_FN uint apart(uint bits) {
    bits = (bits | bits << 8) & 0x00ff00ffu;
    bits = (bits | bits << 4) & 0x0f0f0f0fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}
#endif

// The samples from column hx on of row hy will be loaded soon.
LW_FN void expect_samples(const lw_coarse* coarse, int hx, int hy) {
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        will_load(coarse->position + coarse->positionLayout.x + a * coarse->positionLayout.z + hy * coarse->positionLayout.y + hx);
        will_load(coarse->normal + coarse->normalLayout.x + a * coarse->normalLayout.z + hy * coarse->normalLayout.y + hx);
    }
    LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a)
        will_load(coarse->light + coarse->lightLayout.x + a * coarse->lightLayout.z + hy * coarse->lightLayout.y + hx);
}

// The surfaces of 2 * LW_WIDTH pixels from column x on will be: those of the next work-item, which else waits for memory first.
LW_FN void expect_surfaces(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout, int x, int y) {
    LW_UNROLL for (int a = 0; a < 3; ++a) LW_UNROLL for (int next = 0; next < 2; ++next) {
        will_load(position + positionLayout.x + a * positionLayout.z + y * positionLayout.y + x + next * LW_WIDTH);
        will_load(normal + normalLayout.x + a * normalLayout.z + y * normalLayout.y + x + next * LW_WIDTH);
    }
}

LW_FN void clear_sum(lw_sum* sum) {
    LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a) sum->light[a] = (real)0.0f;
    sum->weight = (real)0.0f;
#if LW_MARKS
    sum->least = (real)INFINITY;
    sum->greatest = (real)0.0f;
#endif
}

// A tent over three pixels: a sample stands two pixels from the next, so that an even pixel sees three of them at distances 2, 0, 2 and
// an odd one two at distances 1, 1; rows alike, of which the second of a block sees none above.
LW_FN float column_tent(int i, int odd) { return odd ? 2.0f / 3.0f : i == 0 ? 1.0f : 1.0f / 3.0f; }
LW_FN float row_tent(int j, int k) { return 1.0f - (float)abs(2 * j - k) * (1.0f / 3.0f); }

// Sums of the samples around row k of LW_WIDTH blocks, at their even columns and at their odd ones, within their own samples' slope. All samples
// exist: every load is a plain one. What down-sampling left empty has no normal, and fails the edge test. With LW_MARKS, k is a constant where it
// is called.
LW_FN void sum_inside(lw_sum sum[2], const lw_surface s[2], const lw_coarse* coarse, real slope2, int hx, int hy, int k) {
    lw_edges edges[2];
    LW_UNROLL for (int odd = 0; odd < 2; ++odd) {
        clear_sum(&sum[odd]);
        edges[odd] = edges_within(s[odd], (real)1.0f, slope2);
    }
    const int pz = coarse->positionLayout.z, nz = coarse->normalLayout.z, lz = coarse->lightLayout.z;
    const int last = min(hy + 1, coarse->height - 1);
    for (int row = max(hy - 1 + k, 0); row <= last; ++row) {
        __global const float* p = coarse->position + (coarse->positionLayout.x + row * coarse->positionLayout.y + hx);
        __global const float* n = coarse->normal + (coarse->normalLayout.x + row * coarse->normalLayout.y + hx);
        __global const float* l = coarse->light + (coarse->lightLayout.x + row * coarse->lightLayout.y + hx);
        const float tent = row_tent(row - hy, k);
        LW_UNROLL for (int i = -1; i <= 1; ++i) {
            const real px = load_whole(p + i), py = load_whole(p + pz + i), pzz = load_whole(p + 2 * pz + i);
            const real nx = load_whole(n + i), ny = load_whole(n + nz + i), nzz = load_whole(n + 2 * nz + i);
            real light[LW_CHANNELS];
            LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a) light[a] = load_whole(l + a * lz + i);
            LW_UNROLL for (int odd = 0; odd < 2; ++odd) {
                if (odd && i < 0) continue;
                const real w = tent * column_tent(i, odd) * edge_weight_of_number(edges[odd], px, py, pzz, nx, ny, nzz);
                accumulate(&sum[odd], w, light);
#if LW_MARKS
                if (!odd && k == 0) widen(&sum[0], w, light);
#endif
            }
        }
    }
}

// The same beside borders, and by likeness of the normals alone: rare, so that little code matters more.
LW_FN void sum_any(lw_sum* sum, const lw_surface s, const lw_coarse* coarse, real slope2, int hx, int hy, int k, int odd, int byLikeness) {
    clear_sum(sum);
    const lw_edges edges = edges_within(s, (real)1.0f, slope2);
    const int last = min(hy + 1, coarse->height - 1);
    for (int row = max(hy - 1 + k, 0); row <= last; ++row)
        for (int i = odd ? 0 : -1; i <= 1; ++i) {
            lw_sample q;
            load_sample(&q, coarse, hx, i, row);
            const real tent = select_((real)0.0f, (real)(row_tent(row - hy, k) * column_tent(i, odd)), q.valid);
            const real weight = byLikeness ? fmax(fma_(q.nx, s.nx, fma_(q.ny, s.ny, q.nz * s.nz)), (real)0.0f) + 1e-3f
                                           : edge_weight(edges, q.px, q.py, q.pz, q.nx, q.ny, q.nz);
            accumulate(sum, tent * weight, q.light);
#if LW_MARKS
            if (!odd && k == 0 && !byLikeness) widen(sum, tent * weight, q.light);
#endif
        }
}

// A weight this far below a sample's own tent comes from rounding at the edge tests' borders.
LW_FN mask is_lost(const lw_surface s, const lw_sum sum) { return and_(s.valid, not_(sum.weight > 1e-4f)); }

// Sums around row k of LW_WIDTH blocks, and the pixels that no sample is on the surface of.
LW_FN void sum_around(lw_sum sum[2], mask lost[2], const lw_surface s[2], const lw_coarse* coarse, real slope2, int hx, int hy, int k) {
    if (rarely_(!any_(or_(s[0].valid, s[1].valid))))  // sky
        LW_UNROLL for (int odd = 0; odd < 2; ++odd) clear_sum(&sum[odd]);
    else if (usually_(shift_inside(hx, -1, coarse->width) && shift_inside(hx, 1, coarse->width)))
#if LW_MARKS
        if (k == 0) sum_inside(sum, s, coarse, slope2, hx, hy, 0);
        else sum_inside(sum, s, coarse, slope2, hx, hy, 1);
#else
        sum_inside(sum, s, coarse, slope2, hx, hy, k);
#endif
    else
        LW_UNROLL for (int odd = 0; odd < 2; ++odd) sum_any(&sum[odd], s[odd], coarse, slope2, hx, hy, k, odd, 0);
    LW_UNROLL for (int odd = 0; odd < 2; ++odd) lost[odd] = is_lost(s[odd], sum[odd]);
}

#if LW_MARKS
// Bits of the pixels x + ... that exist, are surfaces, and lost or in a block where light is steep.
LW_FN uint marks_of(const lw_surface s[2], const mask lost[2], mask steep, int x, int width) {
    uint marked = 0;
    LW_UNROLL for (int odd = 0; odd < 2; ++odd) {
        const mask exists = lanei_iota() * 2 + (lanei)(x + odd) < (lanei)width;
        const mask here = and_(and_(s[odd].valid, or_(lost[odd], steep)), exists);
        if (any_(here)) marked |= apart(bits_(here)) << odd;
    }
    return marked;
}
#endif

// Lights lost pixels by samples within the largest slope, or by likeness.
LW_FN void replace(lw_sum* sum, mask lost, const lw_surface s, const lw_coarse* coarse, int hx, int hy, int k, int odd, int byLikeness) {
    if (!any_(lost)) return;
    lw_sum rest;
    sum_any(&rest, s, coarse, (real)(LW_EDGE_SLOPE * LW_EDGE_SLOPE), hx, hy, k, odd, byLikeness);
    sum->weight = select_(sum->weight, rest.weight, lost);
    LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a) sum->light[a] = select_(sum->light[a], rest.light[a], lost);
}

// For pixels that have no sample on their own surface, and those that are neither surface nor background: lights the former by samples within the
// largest slope (their block's sample may be of a flatter surface, or normals leave the geometry's), or else like their neighbourhood, and
// counts those that exist (of the former the latter, by 1; of no surfaces by 1 << 16).
LW_FN int substitute(lw_sum sum[2], const mask lost[2], const lw_surface s[2], const lw_coarse* coarse, int hx, int hy, int k, int width) {
    lanei found = (lanei)0;
    LW_UNROLL for (int odd = 0; odd < 2; ++odd) {
        replace(&sum[odd], lost[odd], s[odd], coarse, hx, hy, k, odd, 0);
        const mask still = and_(lost[odd], is_lost(s[odd], sum[odd])), exists = lanei_iota() * 2 + (lanei)(2 * hx + odd) < (lanei)width;
        replace(&sum[odd], still, s[odd], coarse, hx, hy, k, odd, 1);
        found += selecti_((lanei)0, (lanei)1, and_(still, exists)) + selecti_((lanei)0, (lanei)(1 << 16), and_(s[odd].rejected, exists));
    }
    return sum_(found);
}

// One work-item = 2 * LW_WIDTH pixels of two rows: the even and the odd columns of LW_WIDTH blocks.
// half*: 3 planes each of the half-resolution image, the light LW_CHANNELS; with 5, `fourth` and `fifth` take the
// scalars, and any of the three may be null. counts[0]: pixels that are
// neither surface nor background; counts[1]: pixels lit without edge test. validity, of irradiance only and unless not hasValidity: 1 on
// surfaces, 0 elsewhere. marks, with LW_MARKS: a word for each work-item and row, as LW_REPAIR_BITS has them, a bit for each pixel that has
// no sample on its own surface, and for all of a block whose first one has samples that differ by more than `share`: it sees all that
// the others do, if they are of its surface.
//
// One row after the other: its surfaces and sums then stay in registers.
__kernel void joint_bilateral_upsample(__global const float* position, int4 positionLayout,
                                       __global const float* normal, int4 normalLayout, int width, int height,
                                       __global const float* halfPosition, int4 halfPositionLayout,
                                       __global const float* halfNormal, int4 halfNormalLayout,
                                       __global const float* halfIrradiance, int4 halfIrradianceLayout,
                                       __global float* irradiance, int4 irradianceLayout,
#if LW_CHANNELS == 5
                                       __global float* fourth, int4 fourthLayout, __global float* fifth, int4 fifthLayout,
#endif
#if LW_CHANNELS == 3
                                       __global float* validity, int4 validityLayout, int hasValidity,
#endif
#if LW_MARKS
                                       float share, __global uint* marks,
#endif
                                       __global int* counts) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, hy = (int)get_global_id(1);
    const int x = 2 * hx, y = 2 * hy;
    if (x >= width || y >= height) return;
    const int rowEnd = (width + 15) & ~15, rows = min(2, height - y);
    const lw_coarse coarse = {halfPosition, halfNormal, halfIrradiance, halfPositionLayout, halfNormalLayout, halfIrradianceLayout,
                          (width + 1) / 2, (height + 1) / 2};

    if (hy + 1 < coarse.height) expect_samples(&coarse, hx + 2 * LW_WIDTH, hy + 1);
    const int hasSecond = x + LW_WIDTH < rowEnd;
    const real slope2 = squared_edge_slope(load_surface(halfPosition, halfPositionLayout, halfNormal, halfNormalLayout, hx, hy), halfPosition,
                                           halfPositionLayout, hx, hy, coarse.width, coarse.height);
    int found = 0;
#if LW_MARKS
    mask steep = splat_mask(0);
#endif
    for (int k = 0; k < rows; ++k) {
        lw_pair p[3], n[3];
        load_pairs(p, n, position, positionLayout, normal, normalLayout, x, y + k, rowEnd);
        expect_surfaces(position, positionLayout, normal, normalLayout, x + 2 * LW_WIDTH, y + k);
        const lw_surface s[2] = {surface_of(p, n, 0), surface_of(p, n, 1)};
        lw_sum sum[2];
        mask lost[2];
        sum_around(sum, lost, s, &coarse, slope2, hx, hy, k);
#if LW_MARKS
        if (k == 0) steep = is_steep(&sum[0], share);
        marks[(y + k) * LW_REPAIR_WORDS_OF_ROW(width) + (int)get_global_id(0)] = marks_of(s, lost, steep, x, width);
#endif
        if (rarely_(any_(or_(or_(lost[0], s[0].rejected), or_(lost[1], s[1].rejected)))))
            found += substitute(sum, lost, s, &coarse, hx, hy, k, width);

        real out[LW_CHANNELS][2];
        LW_UNROLL for (int odd = 0; odd < 2; ++odd) {
            const real scale = 1.0f / sum[odd].weight;
            LW_UNROLL for (int a = 0; a < LW_CHANNELS; ++a) out[a][odd] = select_((real)0.0f, sum[odd].light[a] * scale, s[odd].valid);
        }
#define LW_STORE(plane, at, a) store_pair(plane, at, hasSecond, out[a][0], out[a][1])
#if LW_CHANNELS == 5
        if (fourth) LW_STORE(fourth, fourthLayout.x + (y + k) * fourthLayout.y + x, 3);
        if (fifth) LW_STORE(fifth, fifthLayout.x + (y + k) * fifthLayout.y + x, 4);
        if (irradiance)
#endif
            LW_UNROLL for (int a = 0; a < (LW_CHANNELS < 3 ? LW_CHANNELS : 3); ++a)
                LW_STORE(irradiance, irradianceLayout.x + a * irradianceLayout.z + (y + k) * irradianceLayout.y + x, a);
#undef LW_STORE
#if LW_CHANNELS == 3
        if (hasValidity) store_pair(validity, validityLayout.x + (y + k) * validityLayout.y + x, hasSecond, ones_(s[0].valid), ones_(s[1].valid));
#endif
    }
    if (found & 0xffff) atomic_add(counts + 1, found & 0xffff);
    if (found >> 16) atomic_add(counts, found >> 16);
}
