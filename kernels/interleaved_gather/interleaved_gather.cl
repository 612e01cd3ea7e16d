// Interleaved gather (Segovia et al. 2006): in every LW_INTERLEAVE^2 block of pixels each pixel takes
// another subset of the VPLs, and an edge-aware box filter over the same block size puts the subsets
// together again. LW_INTERLEAVE 1 gathers all VPLs at every pixel.
//
// No sub-images are built in memory: a work-item reads LW_INTERLEAVE vectors of one row and turns them,
// in registers, into LW_INTERLEAVE vectors of pixels that share a subset.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4, 8
#endif
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/vpl_tiles.h"

#if LW_INTERLEAVE == 1
#define LW_STAGES 0
#elif LW_INTERLEAVE == 2
#define LW_STAGES 1
#elif LW_INTERLEAVE == 4
#define LW_STAGES 2
#else
#define LW_STAGES 3
#endif
#define LW_UNROLL _Pragma("unroll")

// Consecutive pixels v[0..n) become v[j] = the pixels congruent to j modulo LW_INTERLEAVE. Seen as a
// string of bits (vector index, lane), each stage rotates a pixel's place by one bit.
LW_FN void deal_(real* v) {
    LW_UNROLL for (int stage = 0; stage < LW_STAGES; ++stage) {
        real t[LW_INTERLEAVE];
        LW_UNROLL for (int i = 0; i < LW_INTERLEAVE / 2; ++i) {
            t[i] = even_(v[2 * i], v[2 * i + 1]);
            t[i + LW_INTERLEAVE / 2] = odd_(v[2 * i], v[2 * i + 1]);
        }
        LW_UNROLL for (int i = 0; i < LW_INTERLEAVE; ++i) v[i] = t[i];
    }
}

LW_FN void undeal_(real* v) {
    LW_UNROLL for (int stage = 0; stage < LW_STAGES; ++stage) {
        real t[LW_INTERLEAVE];
        LW_UNROLL for (int i = 0; i < LW_INTERLEAVE / 2; ++i) {
            t[2 * i] = zip_lo_(v[i], v[i + LW_INTERLEAVE / 2]);
            t[2 * i + 1] = zip_hi_(v[i], v[i + LW_INTERLEAVE / 2]);
        }
        LW_UNROLL for (int i = 0; i < LW_INTERLEAVE; ++i) v[i] = t[i];
    }
}

typedef struct { real r, g, b; } rgb;

// Irradiance times pi of `count` VPLs at one vector of surfaces, with the bounded point-to-disc term
//   Phi c_p c / (d^2 + (1 + 3 c_p^2)/4 A/pi),
// written with the unnormalised dot products C = c d and C_p = c_p d:
//   Phi C C_p / (d^4 + (d^2 + 3 C_p^2) A/4pi),
// which needs one division and no square root: on CPUs these two share one slow unit.
// The smallest float keeps a pixel that *is* the VPL at 0 / tiny = 0. Two VPLs at a time: their chains
// of dependent operations then overlap, which one chain alone is too long for.
// `away`: the surface with its normal turned round, so that the offset from VPL to surface serves both
// cosines without a sign to change.
LW_FN void add_two_vpls(rgb* e, const lw_surface away, __global const float* first, __global const float* second) {
    __global const float* vpl[2] = {first, second};
    real dx[2], dy[2], dz[2], d2[2], c[2], w[2];
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        dx[u] = away.px - vpl[u][0];
        dy[u] = away.py - vpl[u][1];
        dz[u] = away.pz - vpl[u][2];
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) d2[u] = fma_(dx[u], dx[u], fma_(dy[u], dy[u], dz[u] * dz[u]));
    LW_UNROLL for (int u = 0; u < 2; ++u)
        c[u] = fmax(fma_(dx[u], away.nx, fma_(dy[u], away.ny, dz[u] * away.nz)), (real)0.0f);
    LW_UNROLL for (int u = 0; u < 2; ++u)
        w[u] = fmax(fma_(dx[u], vpl[u][4], fma_(dy[u], vpl[u][5], dz[u] * vpl[u][6])), (real)0.0f);
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        const real bound = fma_(fma_(3.0f * w[u], w[u], d2[u]), vpl[u][7], 1e-37f);
        w[u] = c[u] * w[u] / fma_(d2[u], d2[u], bound);
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        e->r = fma_(w[u], vpl[u][8], e->r);
        e->g = fma_(w[u], vpl[u][9], e->g);
        e->b = fma_(w[u], vpl[u][10], e->b);
    }
}

// Takes the lowest bit out of `bits` and returns its number.
LW_FN int take_lowest(uint* bits) {
    const int lowest = 31 - (int)clz(*bits & (0u - *bits));
    *bits &= *bits - 1u;
    return lowest;
}

// All VPLs of a subset that the tile has not skipped, in the order of their slots.
LW_FN rgb gather_subset(lw_surface s, __global const float* vpls, lw_subset_order order, int subset,
                        __global const uint* masks, lw_vpl_tiles tiles, int tile) {
    rgb e = {(real)0.0f, (real)0.0f, (real)0.0f};
    s.nx = -s.nx;
    s.ny = -s.ny;
    s.nz = -s.nz;
    vpls += 12 * subset * order.capacity;
    if (tiles.words == 0) {
        for (int k = 0; k < order.capacity; k += 2) add_two_vpls(&e, s, vpls + 12 * k, vpls + 12 * k + 12);
        return e;
    }
    for (int word = 0; word < tiles.words; ++word, vpls += 12 * 32) {
        uint bits = masks[(subset * tiles.words + word) * lw_tile_stride(tiles) + tile];
        while (bits) {
            const int first = take_lowest(&bits), second = take_lowest(&bits);
            add_two_vpls(&e, s, vpls + 12 * first, vpls + 12 * second);
        }
    }
    return e;
}

// One work-item = LW_WIDTH * LW_INTERLEAVE adjacent pixels of one row, of a width x height image.
// vpls: float[12] each, subset by subset, order.capacity (even) of them per subset. masks: as
// interleaved_gather_cull left them, an even number of bits to a word; not read when tiles.words is 0.
// irradiance: 3 planes, W/m^2. counts[0]: pixels that are neither surface nor background; counts[2]: pixels with
// more light than LW_LARGEST_IRRADIANCE.
__kernel void interleaved_gather_gather(__global const float* position, int4 positionLayout,
                                        __global const float* normal, int4 normalLayout, int width, int height,
                                        __global const float* vpls, lw_subset_order order,
                                        __global const uint* masks, lw_vpl_tiles tiles,
                                        __global float* irradiance, int4 irradianceLayout,
                                        __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH * LW_INTERLEAVE, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int rowEnd = (width + 15) & ~15;  // rows can be read up to here
    const int tile = (y / LW_TILE_ROWS) * tiles.columns + x / tiles.tileWidth;

    real p[3][LW_INTERLEAVE], n[3][LW_INTERLEAVE];
    LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j)
        LW_UNROLL for (int a = 0; a < 3; ++a) {
            const int at = x + j * LW_WIDTH;
            p[a][j] = (real)0.0f;
            n[a][j] = (real)0.0f;
            if (at < rowEnd) {
                p[a][j] = load(position, positionLayout.x + a * positionLayout.z + y * positionLayout.y + at);
                n[a][j] = load(normal, normalLayout.x + a * normalLayout.z + y * normalLayout.y + at);
                // Padding may hold anything, a signalling pattern or a stale surface.
                if (at + LW_WIDTH > width)
                    n[a][j] = select_((real)0.0f, n[a][j], lanei_iota() + (lanei)at < (lanei)width);
            }
        }
    LW_UNROLL for (int a = 0; a < 3; ++a) { deal_(p[a]); deal_(n[a]); }

    real e[3][LW_INTERLEAVE];
    int rejectedHere = 0, saturatedHere = 0;
    // Not unrolled: at interleave 8 eight copies of the loop over VPLs cost seconds of compilation.
    for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const lw_surface s = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        rgb sum = {(real)0.0f, (real)0.0f, (real)0.0f};
        if (any_(s.valid)) {
            const int subset = (y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + j;
            sum = gather_subset(s, vpls, order, subset, masks, tiles, tile);
        }
        const real scale = (real)(M_1_PI_F * LW_INTERLEAVE * LW_INTERLEAVE);
        const real r = sum.r * scale, g = sum.g * scale, b = sum.b * scale, most = (real)LW_LARGEST_IRRADIANCE;
        e[0][j] = select_((real)0.0f, fmin(r, most), s.valid);
        e[1][j] = select_((real)0.0f, fmin(g, most), s.valid);
        e[2][j] = select_((real)0.0f, fmin(b, most), s.valid);
        const mask saturated = and_(s.valid, fmax(r, fmax(g, b)) > most);
        if (any_(s.rejected)) rejectedHere += count_(s.rejected);
        if (any_(saturated)) saturatedHere += count_(saturated);
    }
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        undeal_(e[a]);
        LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) {
            const int at = x + j * LW_WIDTH;
            if (at < rowEnd)
                store(e[a][j], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y + at);
        }
    }
    if (rejectedHere) atomic_add(counts, rejectedHere);
    if (saturatedHere) atomic_add(counts + 2, saturatedHere);
}

// One work-item = LW_WIDTH adjacent pixels: 1 where the gather lit a surface, 0 elsewhere.
__kernel void interleaved_gather_validity(__global const float* position, int4 positionLayout,
                                          __global const float* normal, int4 normalLayout, int width, int height,
                                          __global float* validity, int4 validityLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    store(ones_(s.valid), validity, validityLayout.x + y * validityLayout.y + x);
}
