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

#if LW_LIGHT
#define LW_SEEN_PLANES 9
#else
#define LW_SEEN_PLANES 6
#endif

LW_FN lw_seen seen_of(const real* v, mask inside) {
    const lw_seen s = {v[0], v[1], v[2], v[3], v[4], v[5],
#if LW_LIGHT
                       v[6], v[7], v[8],
#else
                       (real)0.0f, (real)0.0f, (real)0.0f,
#endif
                       inside};
    return s;
}

// Fine levels. p: first lane's texel in the first plane; phase: how many lanes' worth of that texel lie before the first
// lane.
LW_FN lw_seen fetch(__global const float* p, int plane, int level, int phase) {
    real v[LW_SEEN_PLANES];
#if LW_WIDTH == 1
    for (int a = 0; a < LW_SEEN_PLANES; ++a) v[a] = p[a * plane];
#else
    if (level == 0) {
        for (int a = 0; a < LW_SEEN_PLANES; ++a) v[a] = load(p, a * plane);
    } else if (level == 1) {
        for (int a = 0; a < LW_SEEN_PLANES; ++a) v[a] = zip_lo_(load(p, a * plane), load(p, a * plane + phase));
    } else {
        const int second = (phase + 1) >> 2, third = (phase + 2) >> 2, fourth = (phase + 3) >> 2;
        for (int a = 0; a < LW_SEEN_PLANES; ++a)
            v[a] = zip_lo_(zip_lo_(load(p, a * plane), load(p, a * plane + third)),
                           zip_lo_(load(p, a * plane + second), load(p, a * plane + fourth)));
    }
#endif
    return seen_of(v, splat_mask(1));
}

// Levels from LW_HORIZON_BLEND on: lanes take one of two rows and of up to four columns. first: of the level; column, row:
// the least that a lane takes, both readable in part only; start: pixel, shifted, of the first lane; y: likewise.
// columnShift, rowShift: the lanes' own, in eighths of a texel.
LW_FN lw_seen fetch_blended(__global const float* first, const lw_horizon_step step, int start, int y, lanei columnShift,
                            lanei rowShift, int column, int row) {
    real v[LW_SEEN_PLANES];
    const int unit = step.level - LW_HORIZON_BLEND;
    const lanei x = ((lanei_iota() + (lanei)start + (columnShift << unit)) >> step.level) + (lanei)(step.dx - column);
    const mask second = ((((lanei)y + (rowShift << unit)) >> step.level) + (lanei)(step.dy - row)) > (lanei)0;
    const mask x1 = x > (lanei)0, x2 = x > (lanei)1, x3 = x > (lanei)2;
    const int rowA = clamp(row, 0, step.rows - 1), rowB = clamp(row + 1, 0, step.rows - 1);
    const mask inA = splat_mask(row >= 0 && row < step.rows), inB = splat_mask(row + 1 >= 0 && row + 1 < step.rows);
    for (int a = 0; a < LW_SEEN_PLANES; ++a) {
        __global const float* p = first + a * step.planeStride + rowA * step.rowStride + column;
        __global const float* q = first + a * step.planeStride + rowB * step.rowStride + column;
        real top = select_((real)p[0], (real)p[1], x1), bottom = select_((real)q[0], (real)q[1], x1);
        top = select_(top, (real)p[2], x2);
        bottom = select_(bottom, (real)q[2], x2);
        if (step.level == LW_HORIZON_BLEND) {
            top = select_(top, (real)p[3], x3);
            bottom = select_(bottom, (real)q[3], x3);
        }
        v[a] = select_(top, bottom, second);
    }
    return seen_of(v, or_(and_(second, inB), and_(not_(second), inA)));
}

#endif
