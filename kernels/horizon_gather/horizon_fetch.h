// What a step shows the LW_WIDTH adjacent pixels of a work-item. On level k above theirs, 2^k of them share a texel: its
// planes are loaded side by side once and spread over the lanes by shuffles that are the same for every lane, since
// gathers would cost five times as much.
#ifndef LW_HORIZON_FETCH_H
#define LW_HORIZON_FETCH_H

#include "shared/surface.h"

#include "shared/horizon_types.h"

typedef struct {
    real px, py, pz, nx, ny, nz;  // unit normal, zero without a surface
    real r, g, b;                 // radiance
    mask inside;                  // of the image
} lw_seen;

// Every plane by name: left to a loop, compilers keep them in memory.
#if LW_LIGHT
#define LW_SEEN_RADIANCE(f) f(6), f(7), f(8)
#else
#define LW_SEEN_RADIANCE(f) (real)0.0f, (real)0.0f, (real)0.0f
#endif
#define LW_SEEN(f, inside) {f(0), f(1), f(2), f(3), f(4), f(5), LW_SEEN_RADIANCE(f), inside}

// Lane l takes lane (l + phase) >> level.
#if LW_WIDTH > 1
#if LW_WIDTH == 16
#define LW_PAIRS_0 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7
#define LW_PAIRS_1 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8
#define LW_FOURS_0 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3
#define LW_FOURS_1 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4
#define LW_FOURS_2 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4
#define LW_FOURS_3 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4
#elif LW_WIDTH == 8
#define LW_PAIRS_0 0, 0, 1, 1, 2, 2, 3, 3
#define LW_PAIRS_1 0, 1, 1, 2, 2, 3, 3, 4
#define LW_FOURS_0 0, 0, 0, 0, 1, 1, 1, 1
#define LW_FOURS_1 0, 0, 0, 1, 1, 1, 1, 2
#define LW_FOURS_2 0, 0, 1, 1, 1, 1, 2, 2
#define LW_FOURS_3 0, 1, 1, 1, 1, 2, 2, 2
#else
#define LW_PAIRS_0 0, 0, 1, 1
#define LW_PAIRS_1 0, 1, 1, 2
#define LW_FOURS_0 0, 0, 0, 0
#define LW_FOURS_1 0, 0, 0, 1
#define LW_FOURS_2 0, 0, 1, 1
#define LW_FOURS_3 0, 1, 1, 1
#endif
#ifdef POCL_DEVICE_ADDRESS_BITS
// One permutation of the whole register. PoCL's shuffle() comes out as a dozen of quarters. (Elsewhere: Oclgrind takes
// lanes that the compiler's own shuffles put together for unset.)
#define LW_SPREADER(name, lanes) \
    LW_FN real name(real v) { return __builtin_shufflevector(v, v, lanes); }
#else
#define LW_SPREADER(name, lanes) \
    LW_FN real name(real v) { return shuffle(v, (laneu)(lanes)); }
#endif
LW_SPREADER(pairs_0, LW_PAIRS_0)
LW_SPREADER(pairs_1, LW_PAIRS_1)
LW_SPREADER(fours_0, LW_FOURS_0)
LW_SPREADER(fours_1, LW_FOURS_1)
LW_SPREADER(fours_2, LW_FOURS_2)
LW_SPREADER(fours_3, LW_FOURS_3)
#endif

// Fine levels. p: first lane's texel in the first plane; phase: how many lanes' worth of that texel lie before the first
// lane. It depends on the step alone, so that the branches are the same for all work-items.
LW_FN void fetch(lw_seen* seen, __global const float* p, int plane, int level, int phase) {
#define LW_PLAIN(a) load(p, (a) * plane)
#if LW_WIDTH == 1
    const lw_seen s = LW_SEEN(LW_PLAIN, splat_mask(1));
    *seen = s;
#else
#define LW_PAIRS_0_OF(a) pairs_0(load(p, (a) * plane))
#define LW_PAIRS_1_OF(a) pairs_1(load(p, (a) * plane))
#define LW_FOURS_0_OF(a) fours_0(load(p, (a) * plane))
#define LW_FOURS_1_OF(a) fours_1(load(p, (a) * plane))
#define LW_FOURS_2_OF(a) fours_2(load(p, (a) * plane))
#define LW_FOURS_3_OF(a) fours_3(load(p, (a) * plane))
#define LW_CASE(condition, f)                       \
    if (condition) {                                \
        const lw_seen s = LW_SEEN(f, splat_mask(1)); \
        *seen = s;                                  \
        return;                                     \
    }
    LW_CASE(level == 0, LW_PLAIN)
    LW_CASE(level == 1 && phase == 0, LW_PAIRS_0_OF)
    LW_CASE(level == 1, LW_PAIRS_1_OF)
    LW_CASE(phase == 0, LW_FOURS_0_OF)
    LW_CASE(phase == 1, LW_FOURS_1_OF)
    LW_CASE(phase == 2, LW_FOURS_2_OF)
    LW_CASE(1, LW_FOURS_3_OF)
#undef LW_CASE
#endif
}

// Levels from LW_HORIZON_BLEND on: lanes take one of two rows and of up to four columns. first: of the level; column, row:
// the least that a lane takes, both readable in part only; start: pixel, shifted, of the first lane; y: likewise.
// columnShift, rowShift: the lanes' own, in sixteenths of a texel. Inside is what lies in the image of width x height pixels that
// the gather runs on: a texel that its border cuts stands for no more than its part in it.
LW_FN void fetch_blended(lw_seen* seen, __global const float* first, const lw_horizon_step* step, int start, int y,
                         lanei columnShift, lanei rowShift, int column, int row, int width, int height) {
    const int unit = step->level - LW_HORIZON_BLEND, plane = step->planeStride;
    const lanei pixelX = lanei_iota() + (lanei)start + ((columnShift << unit) >> 1), pixelY = (lanei)y + ((rowShift << unit) >> 1);
    const lanei x = (pixelX >> step->level) + (lanei)(step->dx - column);
    const mask second = ((pixelY >> step->level) + (lanei)(step->dy - row)) > (lanei)0;
    const mask x1 = x > (lanei)0, x2 = x > (lanei)1, x3 = x > (lanei)2;
    const int rowA = clamp(row, 0, step->rows - 1), rowB = clamp(row + 1, 0, step->rows - 1);
    const lanei placeX = pixelX + (lanei)(step->dx << step->level), placeY = pixelY + (lanei)(step->dy << step->level);
    const mask inside = and_(and_(placeX >= (lanei)0, placeX < (lanei)width), and_(placeY >= (lanei)0, placeY < (lanei)height));
    __global const float* p = first + rowA * step->rowStride + column;
    __global const float* q = first + rowB * step->rowStride + column;
#define LW_THREE(r, a) select_(select_((real)r[(a) * plane], (real)r[(a) * plane + 1], x1), (real)r[(a) * plane + 2], x2)
#define LW_FOUR(r, a) select_(LW_THREE(r, a), (real)r[(a) * plane + 3], x3)
#define LW_BLOCK_3(a) select_(LW_THREE(p, a), LW_THREE(q, a), second)
#define LW_BLOCK_4(a) select_(LW_FOUR(p, a), LW_FOUR(q, a), second)
    if (unit == 0) {
        const lw_seen s = LW_SEEN(LW_BLOCK_4, inside);
        *seen = s;
    } else {
        const lw_seen s = LW_SEEN(LW_BLOCK_3, inside);
        *seen = s;
    }
}

#endif
