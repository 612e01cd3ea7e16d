// An interleaved image in registers (Segovia et al. 2006): a work-item reads LW_INTERLEAVE vectors of one row
// and turns them into LW_INTERLEAVE vectors of pixels that share a subset of the VPLs, and back again. No
// sub-images are built in memory. The including program defines LW_INTERLEAVE as 1, 2, 4 or 8.
#ifndef LW_INTERLEAVE_H
#define LW_INTERLEAVE_H

#include "input_limits.h"
#include "wide.h"

#if LW_INTERLEAVE == 1
#define LW_STAGES 0
#elif LW_INTERLEAVE == 2
#define LW_STAGES 1
#elif LW_INTERLEAVE == 4
#define LW_STAGES 2
#else
#define LW_STAGES 3
#endif

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

// One plane of a row from column x on, dealt. Columns from `width` on become 0: padding may hold anything, a
// signalling pattern or a stale surface. Rows can be read up to the next multiple of 16.
LW_FN void load_dealt(real* v, __global const float* plane, int row, int x, int width) {
    const int rowEnd = (width + 15) & ~15;
    LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const int at = x + j * LW_WIDTH;
        v[j] = (real)0.0f;
        if (at < rowEnd) {
            v[j] = load(plane, row + at);
            if (at + LW_WIDTH > width) v[j] = select_((real)0.0f, v[j], lanei_iota() + (lanei)at < (lanei)width);
        }
    }
    deal_(v);
}

// The next work-item will load its pixels of `row` soon: gathers are long, and wait for memory at each one's beginning.
LW_FN void expect_dealt(__global const float* plane, int row, int x) {
    LW_UNROLL for (int j = LW_INTERLEAVE; j < 2 * LW_INTERLEAVE; ++j) will_load(plane + row + x + j * LW_WIDTH);
}

// The way back; rows can be written as far as they can be read.
LW_FN void store_dealt(real* v, __global float* plane, int row, int x, int width) {
    const int rowEnd = (width + 15) & ~15;
    undeal_(v);
    LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const int at = x + j * LW_WIDTH;
        if (at < rowEnd) store(v[j], plane, row + at);
    }
}

// What a subset's sum means: it stands for all LW_INTERLEAVE^2 of them, and was gathered without the 1/pi.
// Pixels without a surface get 0; true lanes of the result are brought down to LW_LARGEST_IRRADIANCE.
LW_FN mask finish_irradiance(rgb sum, mask valid, real* r, real* g, real* b) {
    const real scale = (real)(M_1_PI_F * LW_INTERLEAVE * LW_INTERLEAVE), most = (real)LW_LARGEST_IRRADIANCE;
    const real wholeR = sum.r * scale, wholeG = sum.g * scale, wholeB = sum.b * scale;
    *r = select_((real)0.0f, fmin(wholeR, most), valid);
    *g = select_((real)0.0f, fmin(wholeG, most), valid);
    *b = select_((real)0.0f, fmin(wholeB, most), valid);
    return and_(valid, fmax(wholeR, fmax(wholeG, wholeB)) > most);
}

#endif
