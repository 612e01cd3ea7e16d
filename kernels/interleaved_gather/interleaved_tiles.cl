// VPLs that cannot light a tile of pixels, found before the gather: those that lie behind every pixel's
// surface and those that face away from all of them. A flat wall sees the VPLs of one side only, so about
// half of all pairs carry nothing. What is skipped would have added exactly 0: the picture keeps its bits.
//
// Source: tiled deferred shading (Olsson and Assarsson 2011) with a box of normals beside the box of
// positions; VPLs have no radius, so only orientation is tested.
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/vpl_tiles.h"

// Rounding of the gather's dot products and of the bounds below, relative to the sum of the products'
// sizes: each is under 8 units of 2^-24. Smaller than that sum, and a pair that the gather would round to
// just above 0 could be skipped: bits would then depend on the tiles.
#define LW_DOT_MARGIN 2e-6f
#define LW_UNROLL _Pragma("unroll")

// Of numbers that are no NaNs: one instruction where fmin and fmax take three.
LW_FN real least(real a, real b) { return select_(b, a, a < b); }
LW_FN real greatest(real a, real b) { return select_(b, a, a > b); }

// One work-item = one tile: the boxes of its surfaces' positions and normals (as long as the host made
// them: only signs matter). bounds: 12 planes, least xyz and greatest xyz of both. A tile without any
// surface gets empty normals, which keep every VPL: the gather does not look there.
__kernel void interleaved_gather_bounds(__global const float* position, int4 positionLayout,
                                        __global const float* normal, int4 normalLayout, int width, int height,
                                        lw_vpl_tiles tiles, __global float* bounds) {
    const int column = (int)get_global_id(0), row = (int)get_global_id(1);
    if (column >= tiles.columns || row >= tiles.rows) return;
    const int x0 = column * tiles.tileWidth, y0 = row * LW_TILE_ROWS;
    const int x1 = min(x0 + tiles.tileWidth, width), y1 = min(y0 + LW_TILE_ROWS, height);

    real low[6], high[6];
    LW_UNROLL for (int a = 0; a < 6; ++a) {
        low[a] = (real)(INFINITY);
        high[a] = (real)(-INFINITY);
    }
    for (int y = y0; y < y1; ++y) {
        // Two rows on, in the next tile after this one's last: pieces of rows are too short for a processor to foresee.
        const int wraps = y + 2 >= y1, yAhead = wraps ? y0 + y + 2 - y1 : y + 2, xAhead = wraps ? tiles.tileWidth : 0;
        for (int x = x0; x < x1; x += LW_WIDTH) {
            const int p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
            real v[6];
            LW_UNROLL for (int a = 0; a < 3; ++a) {
                v[a] = load(position, p + a * positionLayout.z);
                v[a + 3] = load(normal, n + a * normalLayout.z);
                will_load(position + positionLayout.x + a * positionLayout.z + yAhead * positionLayout.y + x + xAhead);
                will_load(normal + normalLayout.x + a * normalLayout.z + yAhead * normalLayout.y + x + xAhead);
            }
            // Padding may hold anything.
            const mask inside = lanei_iota() + (lanei)x < (lanei)width;
            const mask valid = and_(is_surface(v[0], v[1], v[2], v[3], v[4], v[5]), inside);
            LW_UNROLL for (int a = 0; a < 6; ++a) {
                low[a] = select_(low[a], least(v[a], low[a]), valid);
                high[a] = select_(high[a], greatest(v[a], high[a]), valid);
            }
        }
    }
    const int tile = row * tiles.columns + column;
    const int empty = min_lane(low[0]) > max_lane(high[0]);
    LW_UNROLL for (int a = 0; a < 6; ++a) {
        bounds[(a < 3 ? a : a + 3) * lw_tile_stride(tiles) + tile] = empty ? 0.0f : min_lane(low[a]);
        bounds[(a < 3 ? a + 3 : a + 6) * lw_tile_stride(tiles) + tile] = empty ? 0.0f : max_lane(high[a]);
    }
    // The tiles that only pad the planes: lanes of the next kernel read them.
    if (tile == tiles.columns * tiles.rows - 1)
        for (int a = 0; a < 12; ++a)
            for (int t = tile + 1; t < lw_tile_stride(tiles); ++t) bounds[a * lw_tile_stride(tiles) + t] = 0.0f;
}

// The greatest value of a * b over two intervals.
LW_FN real greatest_product(real aLow, real aHigh, real bLow, real bHigh) {
    return greatest(greatest(aLow * bLow, aLow * bHigh), greatest(aHigh * bLow, aHigh * bHigh));
}

// One work-item = LW_WIDTH adjacent tiles and one word of one subset: the bits of its slots.
__kernel void interleaved_gather_cull(__global const float* bounds, lw_vpl_tiles tiles, __global const float* vpls,
                                      lw_subset_order order, __global uint* masks) {
    const int tile = (int)get_global_id(0) * LW_WIDTH, word = (int)get_global_id(1);
    if (tile >= lw_tile_stride(tiles) || word >= order.subsets * tiles.words) return;
    real box[12];
    LW_UNROLL for (int a = 0; a < 12; ++a) box[a] = load(bounds, a * lw_tile_stride(tiles) + tile);

    // Not by %: beside / it becomes an instruction that Oclgrind's check cannot follow.
    const int subset = word / tiles.words, first = (word - subset * tiles.words) * 32;
    const int count = min(32, order.capacity - first);
    __global const float* vpl = vpls + 12 * (subset * order.capacity + first);
    laneu bits = (laneu)0;
    for (int k = 0; k < count; ++k, vpl += 12) {
        if (!(vpl[8] > 0.0f || vpl[9] > 0.0f || vpl[10] > 0.0f)) continue;
        real cosine = (real)0.0f, vplCosine = (real)0.0f, size = (real)0.0f;
        LW_UNROLL for (int a = 0; a < 3; ++a) {
            // To the VPL, from anywhere in the box.
            const real low = vpl[a] - box[a + 3], high = vpl[a] - box[a];
            cosine += greatest_product(low, high, box[a + 6], box[a + 9]);
            vplCosine += greatest(-low * vpl[4 + a], -high * vpl[4 + a]);
            size += greatest(fabs(low), fabs(high));
        }
        const mask seen = and_(cosine > -LW_DOT_MARGIN * size, vplCosine > -LW_DOT_MARGIN * size);
        bits |= selectu_((laneu)0, (laneu)(1u << k), seen);
    }
    // The gather takes two at a time: an odd one is joined by a slot that adds nothing.
    bits |= selectu_((laneu)0, ~bits & (bits + (laneu)1), to_mask(popcount(bits) & (laneu)1));
    store(bits, masks, word * lw_tile_stride(tiles) + tile);
}
