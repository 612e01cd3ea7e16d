// The cells that specular rays march through (lpv_specular_types.h), made of what either transport of a light propagation volume
// injects, and of what blocks there; and their coarser levels.
#include "shared/lpv_specular_types.h"
#include "shared/lpv_sweep_types.h"
#include "shared/lpv_types.h"
#include "shared/wide.h"

#define LPV_TO_FLUX 1.1283791671f   // 1 / LOBE0
#define LPV_TO_NORMAL 0.9772050238f  // 1 / LOBE1

// Of the areas that propagation blocks with: surfels are drawn by chance, and a closed wall's corners have 0.8 to 1.2 of a side. Less:
// walls show what lies behind; more: what is half open is closed.
#define SPECULAR_CLOSING 1.25f

LW_FN float closed_by(float area) { return fmin(area, 1.0f); }

// The mean of a face's four corners, of one coordinate of what blocks (|n| areas, without the normals' signs).
LW_FN float face_of(float a, float b, float c, float d) {
    return closed_by(0.25f * SPECULAR_CLOSING * LPV_TO_NORMAL * (fabs(a) + fabs(b) + fabs(c) + fabs(d)));
}

// One work-item = one cell (x; y and z) of injected light, a grid of lpv_types.h. corners: lpv_blocking's, where hasCorners: a cell's
// ways are closed by its faces towards lower neighbours.
__kernel void lpv_specular_pack_steps(__global const float* injected, __global const LwLpvPlace* grid, int size,
                                      __global const float4* corners, int hasCorners, __global float4* cells) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size;
    if (x >= size || line >= size * size) return;
    const int plane = lpv_plane(size), row = size + 1, slice = row * row;
    const float inverse = grid->origin.w;
    __global const float* from = injected + lpv_cell(size, x, y, z);
    float v[LW_SPECULAR_CELL];
    for (int band = 0; band < LW_LPV_BANDS; ++band)
        for (int c = 0; c < LW_LPV_COLOURS; ++c)
            v[4 * band + c] =
                from[(LW_LPV_BANDS * c + band) * plane] * (band == 0 ? LPV_TO_FLUX : LPV_TO_NORMAL) * inverse * inverse;
    v[3] = v[7] = v[11] = v[15] = 0.0f;
    if (hasCorners) {
        __global const float4* b = corners + (z * row + y) * row + x;
        v[3] = face_of(b[0].y, b[row].y, b[slice].y, b[slice + row].y);
        v[7] = face_of(b[0].z, b[1].z, b[slice].z, b[slice + 1].z);
        v[11] = face_of(b[0].w, b[1].w, b[row].w, b[row + 1].w);
    }
    __global float4* to = cells + 4 * (line * size + x);
    for (int i = 0; i < 4; ++i) to[i] = (float4)(v[4 * i], v[4 * i + 1], v[4 * i + 2], v[4 * i + 3]);
}

// Normal k of a sweep.
LW_FN float4 sweep_normal_of(int k) {
    const int code = k < 13 ? k : k + 1;
    const float x = (float)(code % 3 - 1), y = (float)(code / 3 % 3 - 1), z = (float)(code / 9 - 1);
    return (float4)(x, y, z, 0.0f) * rsqrt(x * x + y * y + z * z);
}

// One work-item = one cell (x; y and z) of a sweep: what lpv_sweep_resolve made, in its first order. isAdded: its light beside that
// of the bounces before.
__kernel void lpv_specular_pack_sweep(__global const float* sources, __global const float* sheets, __global const uint* used, int size,
                                      int isAdded, __global float4* cells) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const int here = line * size + x, stride = LW_SWEEP_ORDERS * size * size * size;
    float4 flux = (float4)(0.0f), nx = flux, ny = flux, nz = flux;
    for (uint bits = used[2 * line]; bits;) {
        const int k = take_lowest(&bits);
        __global const float* from = sources + LW_SWEEP_COLOURS * k * stride + here;
        const float4 sent = (float4)(from[0], from[stride], from[2 * stride], 0.0f) * M_1_PI_F, n = sweep_normal_of(k);
        flux += sent;
        nx += n.x * sent;
        ny += n.y * sent;
        nz += n.z * sent;
    }
    float4 areas = (float4)(0.0f);
    for (uint bits = used[2 * line + 1]; bits;) {
        const int k = take_lowest(&bits);
        areas += sheets[k * stride + here] * fabs(sweep_normal_of(k));
    }
    __global float4* to = cells + 4 * here;
    if (isAdded) {
        flux += to[0];
        nx += to[1];
        ny += to[2];
        nz += to[3];
    }
    flux.w = closed_by(areas.x);
    nx.w = closed_by(areas.y);
    ny.w = closed_by(areas.z);
    to[0] = flux;
    to[1] = nx;
    to[2] = ny;
    to[3] = nz;
}

// Two cells behind each other close what the first lets through.
LW_FN float both(float a, float b) { return 1.0f - (1.0f - a) * (1.0f - b); }

// One work-item = one cell (x; y and z) of a level `size` cells a side, of the eight of the level before: the mean of what they send,
// and of the four ways along an axis how much they close. Means along the ways as well would open walls, ever more on
// every level.
__kernel void lpv_specular_halve(__global float4* cells, int from, int to, int size) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size;
    if (x >= size || line >= size * size) return;
    const int n = 2 * size;
    __global const float4* c[8];
    for (int k = 0; k < 8; ++k)
        c[k] = cells + 4 * (from + ((2 * z + (k >> 2)) * n + 2 * y + (k >> 1 & 1)) * n + 2 * x + (k & 1));
    float4 mean[4];
    for (int i = 0; i < 4; ++i)
        mean[i] = 0.125f * (((c[0][i] + c[1][i]) + (c[2][i] + c[3][i])) + ((c[4][i] + c[5][i]) + (c[6][i] + c[7][i])));
    float closed[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int step = 1 << axis, u = axis == 0 ? 2 : 1, v = axis == 2 ? 2 : 4;
        closed[axis] = 0.25f * ((both(c[0][axis].w, c[step][axis].w) + both(c[u][axis].w, c[u + step][axis].w)) +
                                (both(c[v][axis].w, c[v + step][axis].w) + both(c[u + v][axis].w, c[u + v + step][axis].w)));
    }
    __global float4* out = cells + 4 * (to + line * size + x);
    for (int i = 0; i < 3; ++i) mean[i].w = closed[i];
    for (int i = 0; i < 4; ++i) out[i] = mean[i];
}

// The level of a cell of all levels' list; at: its place in the level, side: cells a side.
LW_FN int level_of(int cell, int size, int* at, int* side) {
    int level = 0;
    for (*at = cell, *side = size; *at >= *side * *side * *side && *side > 4; ++level) {
        *at -= *side * *side * *side;
        *side /= 2;
    }
    return level;
}

// One work-item = one cell of all levels: how much its ways are closed, apart from its light; and 0 where it has any of either, or
// else LW_SPECULAR_FAR.
__kernel void lpv_specular_ways(__global const float4* cells, int count, __global float4* ways, __global float* distances) {
    const int i = (int)get_global_id(0);
    if (i >= count) return;
    const float4 c0 = cells[4 * i], x = cells[4 * i + 1], y = cells[4 * i + 2];
    const float most = fmax(fmax(fmax(c0.x, c0.y), fmax(c0.z, c0.w)), fmax(x.w, y.w));
    ways[i] = (float4)(c0.w, x.w, y.w, 0.0f);
    distances[i] = most > 0.0f ? 0.0f : LW_SPECULAR_FAR;
}

// One work-item = one cell of all levels: how far, in its level's cells and as the largest of the three coordinates, the next cell is
// that is not empty; along one axis after the other. isLast: into the ways.
__kernel void lpv_specular_distances(__global const float* from, int count, int size, int axis, int isLast, __global float4* ways,
                                     __global float* to) {
    const int i = (int)get_global_id(0);
    if (i >= count) return;
    int at, side;
    level_of(i, size, &at, &side);
    const int step = axis == 0 ? 1 : axis == 1 ? side : side * side, here = at / step % side;
    float least = from[i];
    for (int k = 1; (float)k < least; ++k) {
        if (here - k >= 0) least = fmin(least, fmax((float)k, from[i - k * step]));
        if (here + k < side) least = fmin(least, fmax((float)k, from[i + k * step]));
    }
    if (isLast) ways[i].w = least;
    else to[i] = least;
}
