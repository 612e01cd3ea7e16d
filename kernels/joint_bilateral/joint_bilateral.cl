// Half resolution and back: a G-buffer of every second column and row, and joint bilateral up-sampling
// (Kopf et al. 2007) of what was computed on it: 3x3 half-resolution samples around a pixel, a tent in
// the distance of pixels, nothing across a depth or normal edge.
#ifndef LW_CHANNELS
#define LW_CHANNELS 3  // of the light: 1 a scalar, 3 irradiance, 5 irradiance and two scalars
#endif
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_weight.h"
#include "shared/neighbours.h"

// The columns 2x and 2x + 1 of LW_WIDTH blocks of two: the even and odd ones of two vectors.
typedef struct { real even, odd; } lw_pair;

LW_FN lw_pair load_pair(__global const float* image, int row, int x, int rowEnd) {
    const real a = load(image, row + x);
    const real b = x + LW_WIDTH < rowEnd ? load(image, row + x + LW_WIDTH) : (real)0.0f;
    const lw_pair pair = {even_(a, b), odd_(a, b)};
    return pair;
}

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

    lw_pair p[2][3], n[2][3];
    for (int j = 0; j < 2; ++j)
        for (int a = 0; a < 3; ++a) {
            const int y = min(2 * hy + j, height - 1);
            p[j][a] = load_pair(position, positionLayout.x + a * positionLayout.z + y * positionLayout.y, 2 * hx, rowEnd);
            n[j][a] = load_pair(normal, normalLayout.x + a * normalLayout.z + y * normalLayout.y, 2 * hx, rowEnd);
        }
    lw_surface s = surface_of(p[0], n[0], 0);
    s.valid = and_(s.valid, evenInside);
    prefer(&s, surface_of(p[1], n[1], 1), oddInside);
    prefer(&s, surface_of(p[0], n[0], 1), oddInside);
    prefer(&s, surface_of(p[1], n[1], 0), evenInside);

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

typedef struct { real light[LW_CHANNELS], weight; } lw_sum;

LW_FN void accumulate(lw_sum* sum, real w, const real* light) {
    for (int a = 0; a < LW_CHANNELS; ++a) sum->light[a] = fma_(w, light[a], sum->light[a]);
    sum->weight += w;
}

// Light from one sample to `s`: by the edge test; and, for pixels that no sample passes it for, by
// likeness of the normals alone, so that such a pixel is lit like its neighbourhood and not black.
LW_FN void add_sample(lw_sum* sum, lw_sum* rest, const lw_surface s, const lw_surface q, real tent, const real* light) {
    const real t = select_((real)0.0f, tent, q.valid);
    accumulate(sum, t * edge_weight(edges_of(s, (real)1.0f), q.px, q.py, q.pz, q.nx, q.ny, q.nz), light);
    const real likeness = fmax(fma_(q.nx, s.nx, fma_(q.ny, s.ny, q.nz * s.nz)), (real)0.0f) + 1e-3f;
    accumulate(rest, t * likeness, light);
}

// Where a row of the half-resolution images begins, and the distances between planes.
typedef struct { int position, normal, irradiance, positionPlane, normalPlane, irradiancePlane; } lw_half_row;

// The samples left of, in and right of LW_WIDTH blocks, of one half-resolution row. `inside`, a constant:
// all of them exist, so that every tap is contiguous.
LW_FN void add_half_row(lw_sum* evenSum, lw_sum* oddSum, lw_sum* evenRest, lw_sum* oddRest, const lw_surface even,
                        const lw_surface odd, __global const float* halfPosition, __global const float* halfNormal,
                        __global const float* halfIrradiance, const lw_half_row row, int hx, int halfWidth, float rowTent,
                        const int inside) {
#define LW_TAP(image, at) (inside ? load(image, (at) + hx + i) : load_shifted(image, (at), hx, i, halfWidth))
    for (int i = -1; i <= 1; ++i) {
        lw_surface q;
        q.px = LW_TAP(halfPosition, row.position);
        q.py = LW_TAP(halfPosition, row.position + row.positionPlane);
        q.pz = LW_TAP(halfPosition, row.position + 2 * row.positionPlane);
        q.nx = LW_TAP(halfNormal, row.normal);  // unit or zero: down-sampling saw to it
        q.ny = LW_TAP(halfNormal, row.normal + row.normalPlane);
        q.nz = LW_TAP(halfNormal, row.normal + 2 * row.normalPlane);
        q.valid = fma_(q.nx, q.nx, fma_(q.ny, q.ny, q.nz * q.nz)) > 0.5f;
        if (!inside) {
            const lanei column = lanei_iota() + (lanei)(hx + i);
            q.valid = and_(q.valid, and_(column >= (lanei)0, column < (lanei)halfWidth));
        }
        real light[LW_CHANNELS];
        for (int a = 0; a < LW_CHANNELS; ++a) light[a] = LW_TAP(halfIrradiance, row.irradiance + a * row.irradiancePlane);
        add_sample(evenSum, evenRest, even, q, (real)(rowTent * (i == 0 ? 1.0f : 1.0f / 3.0f)), light);
        if (i >= 0) add_sample(oddSum, oddRest, odd, q, (real)(rowTent * (2.0f / 3.0f)), light);
    }
#undef LW_TAP
}

// Of one plane the even and odd pixels, weighted sums made means.
LW_FN void store_mean(__global float* plane, int at, int hasSecond, const lw_sum* even, const lw_sum* evenRest, const lw_sum* odd,
                      const lw_sum* oddRest, int a, mask evenLost, mask oddLost, real evenScale, real oddScale, mask evenValid,
                      mask oddValid) {
    const real zero = (real)0.0f;
    const real e = select_(zero, select_(even->light[a], evenRest->light[a], evenLost) * evenScale, evenValid);
    const real o = select_(zero, select_(odd->light[a], oddRest->light[a], oddLost) * oddScale, oddValid);
    store(zip_lo_(e, o), plane, at);
    if (hasSecond) store(zip_hi_(e, o), plane, at + LW_WIDTH);
}

// One work-item = 2 * LW_WIDTH pixels of one row: the even ones and the odd ones of LW_WIDTH blocks.
// half*: 3 planes each of the half-resolution image, the light LW_CHANNELS; with 5, `fourth` and `fifth` take the
// scalars, and any of the three may be null. counts[0]: pixels that are
// neither surface nor background; counts[1]: pixels lit without edge test.
__kernel void joint_bilateral_upsample(__global const float* position, int4 positionLayout,
                                       __global const float* normal, int4 normalLayout, int width, int height,
                                       __global const float* halfPosition, int4 halfPositionLayout,
                                       __global const float* halfNormal, int4 halfNormalLayout,
                                       __global const float* halfIrradiance, int4 halfIrradianceLayout,
                                       __global float* irradiance, int4 irradianceLayout,
#if LW_CHANNELS == 5
                                       __global float* fourth, int4 fourthLayout, __global float* fifth, int4 fifthLayout,
#endif
                                       __global int* counts) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    const int x = 2 * hx;
    if (x >= width || y >= height) return;
    const int rowEnd = (width + 15) & ~15;
    const int halfWidth = (width + 1) / 2, halfHeight = (height + 1) / 2;

    lw_pair p[3], n[3];
    for (int a = 0; a < 3; ++a) {
        p[a] = load_pair(position, positionLayout.x + a * positionLayout.z + y * positionLayout.y, x, rowEnd);
        n[a] = load_pair(normal, normalLayout.x + a * normalLayout.z + y * normalLayout.y, x, rowEnd);
    }
    const lw_surface even = surface_of(p, n, 0), odd = surface_of(p, n, 1);

    lw_sum none;
    for (int a = 0; a < LW_CHANNELS; ++a) none.light[a] = (real)0.0f;
    none.weight = (real)0.0f;
    lw_sum evenSum = none, oddSum = none, evenRest = none, oddRest = none;
    // A tent over three pixels: a sample stands two pixels from the next, so that an even pixel sees
    // three of them at distances 2, 0, 2 and an odd one two at distances 1, 1.
    const int oddRow = y & 1;
    const int inside = shift_inside(hx, -1, halfWidth) && shift_inside(hx, 1, halfWidth);
    for (int j = oddRow ? 0 : -1; j <= 1; ++j) {
        const int hy = y / 2 + j;
        if (hy < 0 || hy >= halfHeight) continue;
        const float rowTent = 1.0f - (float)abs(2 * j - oddRow) * (1.0f / 3.0f);
        const lw_half_row row = {halfPositionLayout.x + hy * halfPositionLayout.y,
                                 halfNormalLayout.x + hy * halfNormalLayout.y,
                                 halfIrradianceLayout.x + hy * halfIrradianceLayout.y,
                                 halfPositionLayout.z, halfNormalLayout.z, halfIrradianceLayout.z};
        if (inside)
            add_half_row(&evenSum, &oddSum, &evenRest, &oddRest, even, odd, halfPosition, halfNormal, halfIrradiance, row,
                         hx, halfWidth, rowTent, 1);
        else
            add_half_row(&evenSum, &oddSum, &evenRest, &oddRest, even, odd, halfPosition, halfNormal, halfIrradiance, row,
                         hx, halfWidth, rowTent, 0);
    }

    // A weight this far below a sample's own tent comes from rounding at the edge tests' borders.
    const mask evenLost = and_(even.valid, not_(evenSum.weight > 1e-4f));
    const mask oddLost = and_(odd.valid, not_(oddSum.weight > 1e-4f));
    const real evenScale = 1.0f / select_(evenSum.weight, evenRest.weight, evenLost);
    const real oddScale = 1.0f / select_(oddSum.weight, oddRest.weight, oddLost);
    const int hasSecond = x + LW_WIDTH < rowEnd;
#define LW_STORE_MEAN(plane, at, a)                                                                                   \
    store_mean(plane, at, hasSecond, &evenSum, &evenRest, &oddSum, &oddRest, a, evenLost, oddLost, evenScale, oddScale, \
               even.valid, odd.valid)
#if LW_CHANNELS == 5
    if (fourth) LW_STORE_MEAN(fourth, fourthLayout.x + y * fourthLayout.y + x, 3);
    if (fifth) LW_STORE_MEAN(fifth, fifthLayout.x + y * fifthLayout.y + x, 4);
    if (irradiance)
#endif
        for (int a = 0; a < min(LW_CHANNELS, 3); ++a)
            LW_STORE_MEAN(irradiance, irradianceLayout.x + y * irradianceLayout.y + x + a * irradianceLayout.z, a);
#undef LW_STORE_MEAN
    const lanei at = lanei_iota() * 2 + (lanei)x;
    const mask lostEven = and_(evenLost, at < (lanei)width), lostOdd = and_(oddLost, at + 1 < (lanei)width);
    if (any_(or_(lostEven, lostOdd))) atomic_add(counts + 1, count_(lostEven) + count_(lostOdd));
    const mask badEven = and_(even.rejected, at < (lanei)width), badOdd = and_(odd.rejected, at + 1 < (lanei)width);
    if (any_(or_(badEven, badOdd))) atomic_add(counts, count_(badEven) + count_(badOdd));
}
