// VPLs drawn for tiles of pixels, in proportion to a bound of what they can bring there: the source of the candidates that
// vpl_resampling_gather resamples (resampled importance sampling, Talbot et al. 2005).
//
// A list sorted by cluster is cut into blocks of consecutive slots. A tile weighs a block by its flux times a bound of the
// form factor between the boxes around both, and within the block VPLs by their flux. All draws of a tile are one systematic
// sample of this distribution, in the order of the list: its pixels take them in turns, so that a window of n x n
// pixels holds the whole sample, and a pixel's own draws lie in few clusters.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 1  // of no importance here
#endif
#include "resampling_numbers.h"
#include "shared/spread_number.h"
#include "shared/vpl_light.h"
#include "shared/vpl_resampling_types.h"
#include "shared/vpl_tiles.h"
#include "shared/wide.h"

// Rounding of the bounds below, relative to the size of what they are made of: too small, and a VPL that just lights a
// pixel could have probability 0.
#define LW_BOUND_MARGIN 4e-6f

// One work-item = one block: its boxes, and the most luminance of flux in a slot.
__kernel void vpl_resampling_blocks(__global const float* vpls, lw_vpl_draws draws, __global lw_vpl_block* blocks) {
    const int block = (int)get_global_id(0);
    if (block >= draws.blocks) return;
    const int end = min((block + 1) * draws.length, draws.slots);
    float low[6], high[6], sum = 0.0f;
    for (int a = 0; a < 6; ++a) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (int slot = block * draws.length; slot < end; ++slot) {
        __global const float* const vpl = vpls + 12 * slot;
        const float flux = luminance(vpl[8], vpl[9], vpl[10]);
        if (flux > 0.0f) {
            for (int a = 0; a < 6; ++a) {
                const float v = vpl[a < 3 ? a : a + 1];
                low[a] = fmin(low[a], v);
                high[a] = fmax(high[a], v);
            }
        }
        sum = fmax(sum, flux);
    }
    float middle[6], half2[2] = {0.0f, 0.0f};
    for (int a = 0; a < 6; ++a) {
        middle[a] = sum > 0.0f ? 0.5f * (low[a] + high[a]) : 0.0f;
        const float reach = sum > 0.0f ? 0.5f * (high[a] - low[a]) : 0.0f;
        half2[a / 3] += reach * reach;
    }
    blocks[block].centre = (float4)(middle[0], middle[1], middle[2], sqrt(half2[0]));
    blocks[block].normal = (float4)(middle[3], middle[4], middle[5], sqrt(half2[1]));
    blocks[block].flux = (float4)(sum, 0.0f, 0.0f, 0.0f);
}

typedef struct {
    real x[3], n[3];       // middles of the boxes around a tile's positions and normals
    real reach, spread;    // half their diagonals
    real size;             // of the numbers that positions are made of
} lw_tile_box;

LW_FN lw_tile_box load_box(__global const float* bounds, lw_vpl_tiles tiles, int tile) {
    lw_tile_box box;
    real half2[2] = {(real)0.0f, (real)0.0f};
    box.size = (real)0.0f;
    LW_UNROLL for (int a = 0; a < 6; ++a) {
        const int plane = a < 3 ? a : a + 3;
        const real low = load(bounds, plane * lw_tile_stride(tiles) + tile);
        const real high = load(bounds, (plane + 3) * lw_tile_stride(tiles) + tile);
        const real middle = 0.5f * (low + high), reach = 0.5f * (high - low);
        half2[a / 3] = fma_(reach, reach, half2[a / 3]);
        if (a < 3) {
            box.x[a] = middle;
            box.size += fabs(middle) + reach;
        } else {
            box.n[a - 3] = middle;
        }
    }
    box.reach = sqrt(half2[0]);
    box.spread = sqrt(half2[1]);
    return box;
}

// What of a block's flux a tile can receive: both cosines are bounds for anywhere in the boxes; the distance is that of the
// middles and of the boxes' own sizes together. 0 only where no VPL of the block lights any pixel of the tile.
LW_FN real form_bound(lw_tile_box box, lw_vpl_block block) {
    const real dx = block.centre.x - box.x[0], dy = block.centre.y - box.x[1], dz = block.centre.z - box.x[2];
    const real distance2 = fma_(dx, dx, fma_(dy, dy, dz * dz)), distance = sqrt(distance2);
    const real size = box.size + (fabs(block.centre.x) + fabs(block.centre.y) + fabs(block.centre.z) + block.centre.w);
    const real reach = fma_((real)LW_BOUND_MARGIN, size, box.reach + block.centre.w);
    const real away = fma_(dx, box.n[0], fma_(dy, box.n[1], dz * box.n[2]));
    const real towards = -fma_(dx, block.normal.x, fma_(dy, block.normal.y, dz * block.normal.z));
    // Normals of a G-buffer are up to twice as long as 1.
    const real receives = fma_(box.spread, distance + reach, fma_((real)2.0f, reach, away));
    const real sends = fma_((real)block.normal.w, distance + reach, reach + towards);
    const real wide2 = fma_(reach, reach, distance2) + 1e-30f;
    const real form = fmin(fmax(receives, 0.0f), 2.0f * distance + reach) * fmin(fmax(sends, 0.0f), distance + reach);
    return form / (wide2 * wide2);
}

// Lanes of tiles that there are.
LW_FN void store_some(real v, __global float* sums, int tile, int count, int slots, int slot) {
    float lanes[LW_WIDTH];
    store(v, lanes, 0);
    for (int lane = 0; lane < LW_WIDTH && tile + lane < count; ++lane) sums[(tile + lane) * slots + slot] = lanes[lane];
}

// Pixels that speak for their tile.
#define LW_SPEAKERS 4
// Share of the bound in a VPL's weight, beside what it brings the tile's speakers: raised, tiles draw by blocks' flux alone; at 0
// light that falls between the speakers alone is drawn never.
#define LW_BOUND_SHARE 0.1f

// Row of speaker k in a tile's LW_TILE_ROWS; all of them together as in a stratified pattern.
LW_FN int speaker_row(int k) { return (k * 2 + (k & 1) * 2 + 1) & (LW_TILE_ROWS - 1); }

LW_FN lw_surface load_speaker(__global const float* position, int4 positionLayout, __global const float* normal,
                              int4 normalLayout, int width, int height, lw_vpl_tiles tiles, lanei row, lanei column, int k) {
    const lanei x = min(column * tiles.tileWidth + tiles.tileWidth * (2 * k + 1) / (2 * LW_SPEAKERS), (lanei)(width - 1));
    const lanei y = min(row * LW_TILE_ROWS + speaker_row(k), (lanei)(height - 1));
    const lanei p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
    const int pz = positionLayout.z, nz = normalLayout.z;
    return make_surface(gather(position, p), gather(position, p + pz), gather(position, p + 2 * pz), gather(normal, n),
                        gather(normal, n + nz), gather(normal, n + 2 * nz));
}

// One work-item = LW_WIDTH adjacent tiles: sums[tile][slot] = what the VPLs up to this one weigh for the tile: by what each
// brings the tile's speakers, and by a bound for its block. bounds: as interleaved_gather_bounds left them.
__kernel void vpl_resampling_weigh(__global const float* position, int4 positionLayout, __global const float* normal,
                                   int4 normalLayout, int width, int height, __global const float* bounds, lw_vpl_tiles tiles,
                                   lw_vpl_draws draws, __global const lw_vpl_block* blocks, __global const float* vpls,
                                   __global float* sums) {
    const int tile = (int)get_global_id(0) * LW_WIDTH, count = tiles.columns * tiles.rows;
    if (tile >= count) return;
    const lw_tile_box box = load_box(bounds, tiles, tile);
    const lanei own = min(tile + lanei_iota(), (lanei)(count - 1)), row = own / tiles.columns, column = own - row * tiles.columns;
    lw_surface speakers[LW_SPEAKERS];
    LW_UNROLL for (int k = 0; k < LW_SPEAKERS; ++k)
        speakers[k] = turned_away(load_speaker(position, positionLayout, normal, normalLayout, width, height, tiles, row, column, k));
    float flux = 0.0f;
    for (int b = 0; b < draws.blocks; ++b) flux = fmax(flux, blocks[b].flux.x);
    const float scale = flux > 0.0f ? 1.0f / flux : 0.0f;
    real sum = (real)0.0f;
    for (int b = 0; b < draws.blocks; ++b) {
        const real bound = form_bound(box, blocks[b]) * LW_BOUND_SHARE;
        const int end = min((b + 1) * draws.length, draws.slots);
        for (int slot = b * draws.length; slot < end; ++slot) {
            __global const float* const vpl = vpls + 12 * slot;
            __global const float* const both[2] = {vpl, vpl};
            const float share = luminance(vpl[8], vpl[9], vpl[10]) * scale;
            real brings = (real)0.0f;
            LW_UNROLL for (int k = 0; k < LW_SPEAKERS; ++k) {
                real w[2];
                weigh_two_vpls(w, speakers[k], both);
                brings += w[0];
            }
            sum = fma_(fma_(brings, 1.0f / LW_SPEAKERS, bound), share, sum);
            if (tile + LW_WIDTH <= count) scatter(sum, sums, own * draws.slots + slot);
            else store_some(sum, sums, tile, count, draws.slots, slot);
        }
    }
}

// The first slot where the sums exceed u.
LW_FN lanei slot_above(__global const float* sums, int slots, real u) {
    lanei below = (lanei)0;
    int step = 1;
    while (step < slots) step *= 2;
    for (; step > 0; step /= 2) {
        const lanei next = below + step;
        const mask inside = next < (lanei)slots;
        const real sum = gather(sums, selecti_((lanei)0, next - 1, inside));
        below = selecti_(below, next, and_(inside, sum <= u));
    }
    return below;
}

// One work-item = one tile: list[subset][i] is candidate i of the pixels of that subset, in the order of slots.
__kernel void vpl_resampling_draw(lw_vpl_tiles tiles, lw_vpl_draws draws, int n, __global const float* sums,
                                  __global lw_vpl_draw* list) {
    const int tile = (int)get_global_id(0);
    if (tile >= tiles.columns * tiles.rows) return;
    sums += tile * draws.slots;
    const int subsets = n * n, count = subsets * draws.candidates, run = subsets / draws.groups;
    list += tile * count;
    const float total = sums[draws.slots - 1], step = total / (float)count;
    const uint number = scalar_hash((uint)tile, draws.key), turn = number & (uint)(subsets - 1);
    const float shift = unit_float(scalar_hash(number, draws.key));
    for (int t = 0; t < count; t += LW_WIDTH) {
        const real u = (lane_iota() + ((float)t + shift)) * step;
        const lanei slot = slot_above(sums, draws.slots, u);
        const real high = gather(sums, slot), low = select_((real)0.0f, gather(sums, max(slot - 1, (lanei)0)), slot > 0);
        const mask drawn = high > low;
        const real weight = select_((real)0.0f, step / select_((real)1.0f, high - low, drawn), drawn);
        int slots[LW_WIDTH];
        float weights[LW_WIDTH];
        store(slot, slots, 0);
        store(weight, weights, 0);
        for (int lane = 0; lane < LW_WIDTH && t + lane < count; ++lane) {
            // Draw t of a group's run of draws goes to the run's subsets in turns.
            const int group = (t + lane) / (run * draws.candidates), within = (t + lane) - group * run * draws.candidates;
            const int place = within / run, numbered = ((within - place * run) * draws.groups + group) ^ (int)turn;
            const lw_vpl_draw draw = {slots[lane], weights[lane]};
            list[numbered * draws.candidates + place] = draw;
        }
    }
}
