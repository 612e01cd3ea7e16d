// Surfels by the bricks that their centres lie in, so that bricks can gather theirs: counted, then listed (in an order that
// nothing depends on). Bins are the grid's bricks and those around it, bin = ((z + 1) (B + 2) + y + 1) (B + 2) + x + 1, then one more
// for discs that reach farther than a brick. Of each bin first those that lie in one brick, then those that may lie in several.
#include "shared/voxel_bins.h"
#include "shared/voxel_grid_types.h"
#include "shared/vpl_list.h"

// Which list a surfel belongs to: 2 bin, + 1 where it may lie in several bricks; -1: none, -2: none, as it lies beyond the grid.
LW_FN int list_of(__global const float* p, int stride, const float4 origin, int size) {
    const float radius = p[LW_SURFEL_RADIUS * stride] * origin.w, reach = radius * OCTAGON_REACH, most = (float)size;
    if (!(radius > 0.0f)) return -1;
    float c[3], low = most, high = -most;
    int cell[3], isInOne = 1;
    for (int a = 0; a < 3; ++a) {
        c[a] = (p[(LW_SURFEL_POSITION + a) * stride] - (a == 0 ? origin.x : a == 1 ? origin.y : origin.z)) * origin.w;
        low = fmin(low, c[a] + reach);
        high = fmax(high, c[a] - reach);
    }
    if (radius < SURFEL_SMALL) {
        for (int a = 0; a < 3; ++a) {
            if (!(c[a] >= 0.0f && c[a] < most)) return -2;
            cell[a] = (int)c[a] / LW_VOXEL_BRICK + 1;
        }
        return 2 * ((cell[2] * bin_side(size) + cell[1]) * bin_side(size) + cell[0]);
    }
    if (low < 0.0f || high >= most) return -2;
    if (reach > LARGE_REACH) return 2 * large_bin(size) + 1;
    for (int a = 0; a < 3; ++a) {
        const float brick = c[a] * (1.0f / LW_VOXEL_BRICK), from = (c[a] - reach) * (1.0f / LW_VOXEL_BRICK) + 2.0f,
                    to = (c[a] + reach) * (1.0f / LW_VOXEL_BRICK) + 2.0f;
        cell[a] = c[a] >= 0.0f ? min((int)brick + 1, bin_side(size) - 1) : 0;
        // (What lies within rounding of a side may belong to both.)
        isInOne = isInOne && (int)(from - 1e-3f) == (int)(to + 1e-3f);
    }
    return 2 * ((cell[2] * bin_side(size) + cell[1]) * bin_side(size) + cell[0]) + (isInOne ? 0 : 1);
}

// Surfels of a work-item, neighbours: those of one list are one atomic.
#define BINS_RUN 32

// One work-item = BINS_RUN surfels: which list each belongs to, and how many each list has.
__kernel void voxel_bins_count(__global const float* surfels, int stride, int count, __global const LwLpvPlace* place, int size,
                               __global int* listOf, __global int* counts, __global LwVoxelGrid* state) {
    const int first = lw_list_index() * BINS_RUN, last = min(first + BINS_RUN, count);
    if (first >= count || !state->stale || !(place->origin.w > 0.0f)) return;
    const float4 origin = place->origin;
    int list = -1, run = 0, outside = 0;
    for (int i = first; i < last; ++i) {
        const int own = list_of(surfels + i, stride, origin, size);
        listOf[i] = own;
        outside += own == -2;
        if (own != list) {
            if (list >= 0) atomic_add(counts + list, run);
            list = own;
            run = 0;
        }
        ++run;
    }
    if (list >= 0) atomic_add(counts + list, run);
    if (outside) atomic_add(&state->outside, outside);
}

// Lists that one work-item adds up.
#define BINS_CHUNK 128

// One work-item = BINS_CHUNK lists.
__kernel void voxel_bins_chunks(__global const int* counts, int lists, __global int* chunks, __global const LwVoxelGrid* state) {
    const int chunk = (int)get_global_id(0), first = chunk * BINS_CHUNK;
    if (first >= lists || !state->stale) return;
    int sum = 0;
    for (int i = first; i < min(first + BINS_CHUNK, lists); ++i) sum += counts[i];
    chunks[chunk] = sum;
}

// One work-item in all.
__kernel void voxel_bins_scan(__global int* chunks, int count, __global const LwVoxelGrid* state) {
    if (get_global_id(0) != 0 || !state->stale) return;
    int sum = 0;
    for (int i = 0; i < count; ++i) {
        const int own = chunks[i];
        chunks[i] = sum;
        sum += own;
    }
}

// One work-item = BINS_CHUNK lists: where each begins; of none, one more, where the last ends.
__kernel void voxel_bins_begin(__global const int* counts, int lists, __global const int* chunks, __global int* begins,
                               __global const LwVoxelGrid* state) {
    const int chunk = (int)get_global_id(0), first = chunk * BINS_CHUNK;
    if (first >= lists || !state->stale) return;
    int at = chunks[chunk];
    for (int i = first; i < min(first + BINS_CHUNK, lists); ++i) {
        begins[i] = at;
        at += counts[i];
        if (i == lists - 1) begins[lists] = at;
    }
}

// One work-item = BINS_RUN surfels, from the lists' ends on: all counts end at 0, for the next record.
__kernel void voxel_bins_list(__global const int* listOf, int count, __global const LwLpvPlace* place, __global int* counts,
                              __global const int* begins, __global int* order, __global const LwVoxelGrid* state) {
    const int first = lw_list_index() * BINS_RUN, last = min(first + BINS_RUN, count);
    if (first >= count || !state->stale || !(place->origin.w > 0.0f)) return;
    for (int i = first; i < last;) {
        const int list = listOf[i];
        int end = i + 1;
        while (end < last && listOf[end] == list) ++end;
        if (list >= 0) {
            const int at = begins[list] + atomic_sub(counts + list, end - i) - (end - i);
            for (int k = i; k < end; ++k) order[at + k - i] = k;
        }
        i = end;
    }
}
