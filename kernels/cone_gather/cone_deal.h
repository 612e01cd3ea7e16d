// A row of pixels dealt out to LW_CONE_COLUMNS vectors of which each has the pixels of one column of the window of cones, and back again
// (as interleave.h has it for powers of two).
#ifndef LW_CONE_DEAL_H
#define LW_CONE_DEAL_H

#ifndef LW_CONE_COLUMNS
#define LW_CONE_COLUMNS 1  // 1, 2, 3, 4 or 8
#endif

#if LW_CONE_COLUMNS == 3
#define LW_INTERLEAVE 1  // load_dealt and store_dealt then go unused
#else
#define LW_INTERLEAVE LW_CONE_COLUMNS
#endif
#include "shared/interleave.h"

#if LW_CONE_COLUMNS == 3
// Lane l of vector j is pixel 3 l + j of the three vectors behind each other.
#if LW_WIDTH == 1
LW_FN void deal_three(real* v) {}
LW_FN void undeal_three(real* v) {}
#else
#define LW_THREE (lanei_iota() * 3)
LW_FN void deal_three(real* v) {
    real t[3];
    LW_UNROLL for (int j = 0; j < 3; ++j) {
        const lanei pixel = LW_THREE + j;
        const real early = shuffle2(v[0], v[1], as_laneu_(pixel & (2 * LW_WIDTH - 1)));
        t[j] = select_(early, shuffle(v[2], as_laneu_(pixel & (LW_WIDTH - 1))), pixel >= (lanei)(2 * LW_WIDTH));
    }
    LW_UNROLL for (int j = 0; j < 3; ++j) v[j] = t[j];
}
LW_FN void undeal_three(real* v) {
    real t[3];
    LW_UNROLL for (int j = 0; j < 3; ++j) {
        const lanei pixel = lanei_iota() + j * LW_WIDTH, lane = pixel / 3, column = pixel - lane * 3;
        const real early = shuffle2(v[0], v[1], as_laneu_(lane + column * LW_WIDTH & (2 * LW_WIDTH - 1)));
        t[j] = select_(early, shuffle(v[2], as_laneu_(lane)), column == (lanei)2);
    }
    LW_UNROLL for (int j = 0; j < 3; ++j) v[j] = t[j];
}
#endif

LW_FN void load_cones(real* v, __global const float* plane, int row, int x, int width) {
    const int rowEnd = (width + 15) & ~15;
    LW_UNROLL for (int j = 0; j < 3; ++j) {
        const int at = x + j * LW_WIDTH;
        v[j] = (real)0.0f;
        if (at < rowEnd) {
            v[j] = load(plane, row + at);
            if (at + LW_WIDTH > width) v[j] = select_((real)0.0f, v[j], lanei_iota() + (lanei)at < (lanei)width);
        }
    }
    deal_three(v);
}
LW_FN void store_cones(real* v, __global float* plane, int row, int x, int width) {
    const int rowEnd = (width + 15) & ~15;
    undeal_three(v);
    LW_UNROLL for (int j = 0; j < 3; ++j) {
        const int at = x + j * LW_WIDTH;
        if (at < rowEnd) store(v[j], plane, row + at);
    }
}
#else
#define load_cones load_dealt
#define store_cones store_dealt
#endif

#endif
