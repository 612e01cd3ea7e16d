// Interleaved gather (Segovia et al. 2006): in every LW_INTERLEAVE^2 block of pixels each pixel takes
// another subset of the VPLs, and an edge-aware box filter over the same block size puts the subsets
// together again. LW_INTERLEAVE 1 gathers all VPLs at every pixel.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4, 8
#endif
#include "shared/vpl_light.h"
#include "shared/vpl_tiles.h"

LW_FN void add_two_vpls(rgb* e, const lw_surface away, __global const float* first, __global const float* second) {
    __global const float* const vpl[2] = {first, second};
    real w[2];
    weigh_two_vpls(w, away, vpl);
    LW_UNROLL for (int u = 0; u < 2; ++u) add_light(e, w[u], vpl[u]);
}

// All VPLs of a subset that the tile has not skipped, in the order of their slots.
LW_FN rgb gather_subset(const lw_surface s, __global const float* vpls, lw_subset_order order, int subset,
                        __global const uint* masks, lw_vpl_tiles tiles, int tile) {
    rgb e = {(real)0.0f, (real)0.0f, (real)0.0f};
    const lw_surface away = turned_away(s);
    vpls += 12 * subset * order.capacity;
    if (tiles.words == 0) {
        for (int k = 0; k < order.capacity; k += 2) add_two_vpls(&e, away, vpls + 12 * k, vpls + 12 * k + 12);
        return e;
    }
    for (int word = 0; word < tiles.words; ++word, vpls += 12 * 32) {
        uint bits = masks[(subset * tiles.words + word) * lw_tile_stride(tiles) + tile];
        while (bits) {
            const int first = take_lowest(&bits), second = take_lowest(&bits);
            add_two_vpls(&e, away, vpls + 12 * first, vpls + 12 * second);
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
    const int tile = (y / LW_TILE_ROWS) * tiles.columns + x / tiles.tileWidth;
    const int positionRow = positionLayout.x + y * positionLayout.y, normalRow = normalLayout.x + y * normalLayout.y;
    real p[3][LW_INTERLEAVE], n[3][LW_INTERLEAVE], e[3][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_dealt(p[a], position, positionRow + a * positionLayout.z, x, width);
        load_dealt(n[a], normal, normalRow + a * normalLayout.z, x, width);
        expect_dealt(position, positionRow + a * positionLayout.z, x);
        expect_dealt(normal, normalRow + a * normalLayout.z, x);
    }

    lanei rejectedHere = (lanei)0, saturatedHere = (lanei)0;
    // Not unrolled: at interleave 8 eight copies of the loop over VPLs cost seconds of compilation.
    for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const lw_surface s = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        rgb sum = {(real)0.0f, (real)0.0f, (real)0.0f};
        if (any_(s.valid)) {
            const int subset = (y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + j;
            sum = gather_subset(s, vpls, order, subset, masks, tiles, tile);
        }
        const mask saturated = finish_irradiance(sum, s.valid, &e[0][j], &e[1][j], &e[2][j]);
        rejectedHere += selecti_((lanei)0, (lanei)1, s.rejected);
        saturatedHere += selecti_((lanei)0, (lanei)1, saturated);
    }
    LW_UNROLL for (int a = 0; a < 3; ++a)
        store_dealt(e[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
    if (any_(to_mask(rejectedHere))) atomic_add(counts, sum_(rejectedHere));
    if (any_(to_mask(saturatedHere))) atomic_add(counts + 2, sum_(saturatedHere));
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
