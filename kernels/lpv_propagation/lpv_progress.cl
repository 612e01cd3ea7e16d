// How much light a propagation's last step still moved, and whether that is so little that the steps may end.
//
// The sum over n steps is S_n = g + P g + ... + P^n g, so what the last one moved is P^n g = S_n - S_(n-1), and its flux is 4 pi Y0
// times its first coefficients' sum: that of g less what has left the grid and what was blocked. Sums are of 16 numbers side by
// side at every width, in one order, since what is decided by them must not depend on it.
#include "shared/lpv_types.h"
#include "shared/wide.h"

LW_FN float sum_of(float16 v) {
    const float8 a = v.lo + v.hi;
    const float4 b = a.lo + a.hi;
    return (b.x + b.z) + (b.y + b.w);
}

// One work-item = one slice of one colour: first coefficients of what the last step moved, and of what was put in.
__kernel void lpv_progress_sum(__global const float* source, __global const float* before, __global const float* now, int size,
                               __global const LwLpvProgress* progress, __global float2* sums) {
    const int item = (int)get_global_id(0);
    if (item >= LW_LPV_COLOURS * size || progress->done) return;
    const int colour = item / size, z = item % size;
    float16 moved = (float16)(0.0f), given = moved;
    for (int y = 0; y < size; ++y) {
        const int row = LW_LPV_BANDS * colour * lpv_plane(size) + lpv_cell(size, 0, y, z);
        for (int x = row; x < row + size; x += 16) {
            moved += vload16(0, now + x) - vload16(0, before + x);
            given += vload16(0, source + x);
        }
    }
    sums[item] = (float2)(sum_of(moved), sum_of(given));
}

// One work-item in all, after `steps` steps. scale: what is to be read by then is multiplied by. target: of a colour's light; what
// no light was put in for takes no part.
__kernel void lpv_progress_decide(__global const float2* sums, int size, int steps, float scale, float target,
                                  __global LwLpvProgress* progress) {
    if (get_global_id(0) != 0 || progress->done) return;
    float moving = 0.0f;
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        float2 sum = (float2)(0.0f);
        for (int z = 0; z < size; ++z) sum += sums[colour * size + z];
        // Of sums beyond float's range nothing is known: no step is left out.
        if (sum.y > 0.0f) moving = fmax(moving, sum.y < INFINITY ? fabs(sum.x) / sum.y : 1.0f);
    }
    progress->steps = steps;
    progress->moving = moving;
    progress->scale = scale;
    progress->done = moving <= target;
}
