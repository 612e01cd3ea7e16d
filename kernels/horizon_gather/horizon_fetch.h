// What a step shows the LW_WIDTH adjacent pixels of a work-item. On level k above theirs, 2^k of them share a texel: its
// planes are loaded side by side once and spread over the lanes by shuffles that are the same for every lane, since
// gathers would cost five times as much.
#ifndef LW_HORIZON_FETCH_H
#define LW_HORIZON_FETCH_H

#include "shared/surface.h"

#include "shared/horizon_types.h"

// Where a step's texels lie; what they hold is taken three planes at a time, most of it only where some lane can use it.
typedef struct {
    __global const float* p;  // first lane's texel in the first plane
    __global const float* q;  // coarse levels: the texel below
    int plane, level;
    int phase;                // fine levels: how many lanes' worth of that texel lie before the first lane
    mask x1, x2, x3, second;  // coarse levels: lanes whose texel is at least so many columns to the right; lanes of the row below
    mask inside;              // of the image
} lw_place;

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

// Fine levels. The phase depends on the step alone, so that the branches are the same for all work-items. (Every plane by
// name: left to a loop, compilers keep them in memory.)
LW_FN void take_fine(const lw_place* at, __global const float* p, real* a, real* b, real* c) {
    const int plane = at->plane;
#define LW_TAKE(spread)                  \
    *a = spread(load(p, 0));             \
    *b = spread(load(p, plane));         \
    *c = spread(load(p, 2 * plane));
#define LW_PLAIN(v) (v)
#if LW_WIDTH == 1
    LW_TAKE(LW_PLAIN)
#else
    const int level = at->level, phase = at->phase;
    if (level == 0) {
        LW_TAKE(LW_PLAIN)
    } else if (level == 1 && phase == 0) {
        LW_TAKE(pairs_0)
    } else if (level == 1) {
        LW_TAKE(pairs_1)
    } else if (phase == 0) {
        LW_TAKE(fours_0)
    } else if (phase == 1) {
        LW_TAKE(fours_1)
    } else if (phase == 2) {
        LW_TAKE(fours_2)
    } else {
        LW_TAKE(fours_3)
    }
#endif
#undef LW_TAKE
}

// Levels from LW_HORIZON_BLEND on: lanes take one of two rows and of three columns, on the first of these levels of four.
LW_FN real take_coarse(const lw_place* at, __global const float* p, __global const float* q) {
    real a = select_(select_((real)p[0], (real)p[1], at->x1), (real)p[2], at->x2);
    real b = select_(select_((real)q[0], (real)q[1], at->x1), (real)q[2], at->x2);
    if (at->level == LW_HORIZON_BLEND) {
        a = select_(a, (real)p[3], at->x3);
        b = select_(b, (real)q[3], at->x3);
    }
    return select_(a, b, at->second);
}

// Three planes from the first given on.
LW_FN void take(const lw_place* at, int first, real* a, real* b, real* c) {
    const int plane = at->plane;
    __global const float* p = at->p + first * plane;
    if (at->level < LW_HORIZON_BLEND) {
        take_fine(at, p, a, b, c);
    } else {
        __global const float* q = at->q + first * plane;
        *a = take_coarse(at, p, q);
        *b = take_coarse(at, p + plane, q + plane);
        *c = take_coarse(at, p + 2 * plane, q + 2 * plane);
    }
}

// Of a work-item at x, y. 0: no lane of it looks into the image.
LW_FN int place_fine(lw_place* at, __global const float* pyramid, const lw_horizon_step* step, int x, int y) {
    const int start = x + step->phaseX, level = step->level;
    const int row = ((y + step->phaseY) >> level) + step->dy, column = (start >> level) + step->dx;
    const int phase = start & ((1 << level) - 1);
    if (row < 0 || row >= step->rows || column >= step->columns || column + ((LW_WIDTH - 1 + phase) >> level) < 0) return 0;
    at->p = at->q = pyramid + step->first + row * step->rowStride + column;
    at->plane = step->planeStride;
    at->level = level;
    at->phase = phase;
    at->x1 = at->x2 = at->x3 = at->second = splat_mask(0);
    at->inside = splat_mask(1);
    return 1;
}

// columnShift, rowShift: the lanes' own, in sixteenths of a texel. Inside is what lies in the image of width x height pixels that
// the gather runs on: a texel that its border cuts stands for no more than its part in it.
LW_FN int place_coarse(lw_place* at, __global const float* pyramid, const lw_horizon_step* step, int x, int y, lanei columnShift,
                       lanei rowShift, int width, int height) {
    const int level = step->level, unit = level - LW_HORIZON_BLEND, most = 4 << unit;
    const int startX = x + step->phaseX, startY = y + step->phaseY;
    // The least that a lane takes, both readable in part only.
    const int row = ((startY - most) >> level) + step->dy, column = ((startX - most) >> level) + step->dx;
    if (row < -1 || row >= step->rows || column >= step->columns || ((startX + LW_WIDTH - 1 + most) >> level) + step->dx < 0) return 0;
    const lanei pixelX = lanei_iota() + (lanei)startX + ((columnShift << unit) >> 1), pixelY = (lanei)startY + ((rowShift << unit) >> 1);
    const lanei right = (pixelX >> level) + (lanei)(step->dx - column);
    const lanei placeX = pixelX + (lanei)(step->dx << level), placeY = pixelY + (lanei)(step->dy << level);
    const int rowA = clamp(row, 0, step->rows - 1), rowB = clamp(row + 1, 0, step->rows - 1);
    at->p = pyramid + step->first + rowA * step->rowStride + column;
    at->q = pyramid + step->first + rowB * step->rowStride + column;
    at->plane = step->planeStride;
    at->level = level;
    at->phase = 0;
    at->x1 = right > (lanei)0;
    at->x2 = right > (lanei)1;
    at->x3 = right > (lanei)2;
    at->second = ((pixelY >> level) + (lanei)(step->dy - row)) > (lanei)0;
    at->inside = and_(and_(placeX >= (lanei)0, placeX < (lanei)width), and_(placeY >= (lanei)0, placeY < (lanei)height));
    return 1;
}

#endif
