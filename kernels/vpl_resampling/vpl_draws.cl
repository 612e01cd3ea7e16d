// VPLs drawn for tiles of pixels, in proportion to a bound of what they can bring there: the source of the candidates that
// vpl_resampling_gather resamples (resampled importance sampling, Talbot et al. 2005).
//
// A list sorted by cluster is cut into blocks of consecutive slots. A tile weighs a block by its flux times a bound of the
// form factor between the boxes around both, and within the block VPLs by their flux. All draws of a tile are one systematic
// sample of this distribution, in the order of the list: its pixels take them in turns, so that a window of n x n
// pixels holds the whole sample, and a pixel's own draws lie in few clusters.
#include "resampling_numbers.h"
#include "shared/spread_number.h"
#include "shared/vpl_resampling_types.h"
#include "shared/vpl_tiles.h"
#include "shared/wide.h"

// Rounding of the bounds below, relative to the size of what they are made of: too small, and a VPL that just lights a
// pixel could have probability 0.
#define LW_BOUND_MARGIN 4e-6f

// One work-item = one block: its boxes, and sums[slot] = luminance of the flux of its slots up to this one.
__kernel void vpl_resampling_blocks(__global const float* vpls, lw_vpl_draws draws, __global lw_vpl_block* blocks,
                                    __global float* sums) {
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
        sum += flux;
        sums[slot] = sum;
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

// One work-item = LW_WIDTH adjacent tiles: weights[block] = what the blocks up to this one weigh for the tile. bounds:
// as interleaved_gather_bounds left them.
__kernel void vpl_resampling_weigh(__global const float* bounds, lw_vpl_tiles tiles, lw_vpl_draws draws,
                                   __global const lw_vpl_block* blocks, __global float* weights) {
    const int tile = (int)get_global_id(0) * LW_WIDTH;
    if (tile >= lw_tile_stride(tiles)) return;
    const lw_tile_box box = load_box(bounds, tiles, tile);
    float flux = 0.0f;
    for (int b = 0; b < draws.blocks; ++b) flux = fmax(flux, blocks[b].flux.x);
    const float scale = flux > 0.0f ? 1.0f / flux : 0.0f;
    real sum = (real)0.0f;
    for (int b = 0; b < draws.blocks; ++b) {
        const lw_vpl_block block = blocks[b];
        sum = fma_(form_bound(box, block), block.flux.x * scale, sum);
        store(sum, weights, b * lw_tile_stride(tiles) + tile);
    }
}

// The first slot of a block where the sums exceed `target`, and what the slot adds to them.
LW_FN lanei slot_above(__global const float* sums, lw_vpl_draws draws, lanei block, real target, real* added) {
    const lanei first = block * draws.length, count = min((lanei)draws.length, (lanei)draws.slots - first);
    lanei below = (lanei)0;
    int step = 1;
    while (step < draws.length) step *= 2;
    for (; step > 0; step /= 2) {
        const lanei next = below + step;
        const mask inside = next < count;
        const real sum = gather(sums, first + selecti_((lanei)0, next - 1, inside));
        below = selecti_(below, next, and_(inside, sum <= target));
    }
    const real before = select_((real)0.0f, gather(sums, first + max(below - 1, (lanei)0)), below > 0);
    *added = gather(sums, first + below) - before;
    return first + below;
}

// LW_WIDTH consecutive draws of a tile, at `u` of its weights' sum. *block: where to look from; moved on.
LW_FN void draw_slots(real u, float first, float last, __global const float* weights, int stride, lw_vpl_draws draws,
                      __global const float* sums, int* block, lanei* slot, real* share) {
    while (*block < draws.blocks - 1 && weights[*block * stride] <= first) ++*block;
    lanei at = (lanei)*block;
    for (int b = *block; b < draws.blocks - 1 && weights[b * stride] <= last; ++b)
        at += selecti_((lanei)0, (lanei)1, weights[b * stride] <= u);
    const real high = gather(weights, at * stride);
    const real low = select_((real)0.0f, gather(weights, max(at - 1, (lanei)0) * stride), at > 0);
    const lanei end = min((at + 1) * draws.length, (lanei)draws.slots) - 1;
    const real flux = gather(sums, end), width = high - low;
    const mask some = and_(width > 0.0f, flux > 0.0f);
    const real within = fmax(fmin((u - low) / select_((real)1.0f, width, some), 0.99999994f), 0.0f);
    real added;
    *slot = slot_above(sums, draws, at, within * flux, &added);
    const mask drawn = and_(some, added > 0.0f);
    // 1 / probability, over the weights' sum.
    *share = select_((real)0.0f, flux / (select_((real)1.0f, added, drawn) * select_((real)1.0f, width, drawn)), drawn);
}

// One work-item = one tile: list[subset][i] is candidate i of the pixels of that subset, in the order of slots.
__kernel void vpl_resampling_draw(lw_vpl_tiles tiles, lw_vpl_draws draws, int n, __global const float* weights,
                                  __global const float* sums, __global lw_vpl_draw* list) {
    const int tile = (int)get_global_id(0), stride = lw_tile_stride(tiles);
    if (tile >= tiles.columns * tiles.rows) return;
    weights += tile;
    const int subsets = n * n, count = subsets * draws.candidates, run = subsets / draws.groups;
    list += tile * count;
    const float total = weights[(draws.blocks - 1) * stride], step = total / (float)count;
    const uint number = scalar_hash((uint)tile, draws.key), turn = number & (uint)(subsets - 1);
    const float shift = unit_float(scalar_hash(number, draws.key));
    int block = 0;
    for (int t = 0; t < count; t += LW_WIDTH) {
        lanei slot;
        real share;
        const real u = (lane_iota() + ((float)t + shift)) * step;
        draw_slots(u, ((float)t + shift) * step, ((float)(LW_WIDTH - 1) + ((float)t + shift)) * step, weights, stride, draws, sums,
                   &block, &slot, &share);
        int slots[LW_WIDTH];
        float shares[LW_WIDTH];
        store(slot, slots, 0);
        store(share * step, shares, 0);
        for (int lane = 0; lane < LW_WIDTH && t + lane < count; ++lane) {
            // Draw t of a group's run of draws goes to the run's subsets in turns.
            const int group = (t + lane) / (run * draws.candidates), within = (t + lane) - group * run * draws.candidates;
            const int place = within / run, numbered = ((within - place * run) * draws.groups + group) ^ (int)turn;
            const lw_vpl_draw draw = {slots[lane], shares[lane]};
            list[numbered * draws.candidates + place] = draw;
        }
    }
}
