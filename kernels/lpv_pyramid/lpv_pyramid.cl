// Propagation on a pyramid of grids, each with cells twice as long as the one before: what still moves after a few steps on one
// grid goes on on the next, and what that brings is added back.
//
// With P_l a step on grid l, k_l its steps, D eight cells added up to one and U cells read by interpolation,
//   S_0 = sum over 0 <= i <= k_0 of P_0^i g         (g: the light put in)
//   g_l+1 = D P_l^k_l g_l                           what the last step moved, S_l less the sum before it
//   S_l = sum over 1 <= i <= k_l of P_l^i g_l       without g_l itself, which the grid before has counted
//   T_l = S_l + U T_l+1 / 4                         what is read is T_0
// so that each path is counted once: on the grid that it is on when it reaches a cell. D keeps flux and what it carries along each
// axis. A coarser cell's light passes through four times the area, hence the quarter.
#include "shared/lpv_types.h"
#include "shared/wide.h"

// One work-item in all: the same place in cells of twice the side.
__kernel void lpv_pyramid_place(__global const LwLpvPlace* from, __global LwLpvPlace* to) {
    if (get_global_id(0) != 0) return;
    LwLpvPlace place = *from;
    place.origin.w *= 0.5f;
    place.cell.x *= 2.0f;
    *to = place;
}

// One work-item = one cell (x; y and z) of the coarser grid, of `size` cells a side: the sum of eight of what the last step moved.
__kernel void lpv_pyramid_down(__global const float* before, __global const float* now, int size, __global float* to) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size;
    if (x >= size || line >= size * size) return;
    const int fine = lpv_cell(2 * size, 2 * x, 2 * y, 2 * z), row = lpv_row(2 * size), slice = lpv_slice(2 * size);
    for (int p = 0; p < LW_LPV_PLANES; ++p) {
        float sum = 0.0f;
        for (int k = 0; k < 4; ++k) {
            const int at = p * lpv_plane(2 * size) + fine + ((k & 1) ? row : 0) + ((k & 2) ? slice : 0);
            sum += (now[at] - before[at]) + (now[at + 1] - before[at + 1]);
        }
        to[p * lpv_plane(size) + lpv_cell(size, x, y, z)] = sum;
    }
}

// Of a fine cell's centre: the lower coarse cell beside it, and the upper one's share. Beyond the outermost centres their light
// holds, as for those who read.
LW_FN float coarse_split(int fine, int coarseSize, int* lower) {
    const float inside = clamp(0.5f * (float)fine - 0.25f, 0.0f, (float)(coarseSize - 1));
    *lower = min((int)inside, coarseSize - 2);
    return inside - (float)*lower;
}

// One work-item = one cell (x; y and z) of a grid of `size` cells a side: S + P g .. + P^k g becomes T. isFirst: g counts here, so it
// stays; else it is taken off. hasCoarse: there is a coarser grid's T to add.
__kernel void lpv_pyramid_up(__global float* sum, __global const float* given, int isFirst, __global const float* coarse,
                             int hasCoarse, int size) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size, half_ = size / 2;
    if (x >= size || line >= size * size) return;
    const int at = lpv_cell(size, x, y, z), row = lpv_row(half_), slice = lpv_slice(half_);
    int ix, iy, iz;
    const float fx = coarse_split(x, half_, &ix), fy = coarse_split(y, half_, &iy), fz = coarse_split(z, half_, &iz);
    const int corner = lpv_cell(half_, ix, iy, iz);
    for (int p = 0; p < LW_LPV_PLANES; ++p) {
        const int here = p * lpv_plane(size) + at;
        float light = sum[here] - (isFirst ? 0.0f : given[here]);
        if (hasCoarse) {
            __global const float* c = coarse + p * lpv_plane(half_) + corner;
            const float low = mix(mix(c[0], c[1], fx), mix(c[row], c[row + 1], fx), fy);
            const float high = mix(mix(c[slice], c[slice + 1], fx), mix(c[slice + row], c[slice + row + 1], fx), fy);
            light += 0.25f * mix(low, high, fz);
        }
        sum[here] = light;
    }
}
