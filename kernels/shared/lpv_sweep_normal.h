// Normals as sums of those that sweeps know, see lpv_sweep_types.h.
#ifndef LW_LPV_SWEEP_NORMAL_H
#define LW_LPV_SWEEP_NORMAL_H

#include "lpv_sweep_types.h"
#include "wide.h"

// Lights or surfels of a work-item, which adds up those of one cell and normal before it touches memory that others write as well.
#define LW_SWEEP_RUN 64

// A normal as the sum of three of the set.
typedef struct {
    int bins[3];
    float shares[3];
} sweep_normal;

LW_FN int bin_of(int code) { return code < 13 ? code : code - 1; }

LW_FN sweep_normal normal_of(float nx, float ny, float nz) {
    const float ax = fabs(nx), ay = fabs(ny), az = fabs(nz);
    const int sx = nx < 0.0f ? -1 : 1, sy = ny < 0.0f ? -3 : 3, sz = nz < 0.0f ? -9 : 9;
    const float most = fmax(fmax(ax, ay), az), least = fmin(fmin(ax, ay), az);
    const float middle = fmax(fmin(ax, ay), fmin(fmax(ax, ay), az));
    // Of equal coordinates any may come first: what they would part has no weight.
    const int first = ax == most ? sx : ay == most ? sy : sz, last = az == least ? sz : ay == least ? sy : sx;
    const int all = sx + sy + sz;
    sweep_normal n;
    n.bins[0] = bin_of(13 + first);
    n.bins[1] = bin_of(13 + all - last);
    n.bins[2] = bin_of(13 + all);
    n.shares[0] = most - middle;
    n.shares[1] = 1.414213562f * (middle - least);
    n.shares[2] = 1.732050808f * least;
    return n;
}

#endif
