// Which bricks of a voxel grid are made anew, and where each has its surfaces: bricks that are occupied get slots, in the order of
// the bricks and of the free slots, and keep them for as long as they are.
#include "shared/geometry_types.h"
#include "shared/lpv_types.h"
#include "shared/voxel_grid_types.h"

// One work-item in all: what has changed since the last record? source: 0 nothing, 1 what lies in some boxes, 2 all.
// found: bits of the largest emission, where the host does not know it.
__kernel void voxel_grid_begin(__global const LwLpvPlace* place, int source, float emission, __global const uint* found, int at,
                               int slots, __global LwVoxelGrid* state) {
    if (get_global_id(0) != 0) return;
    const float4 origin = (float4)(place->origin.xyz, place->origin.w > 0.0f ? place->cell.x : 0.0f), last = state->origin;
    const int same = origin.x == last.x && origin.y == last.y && origin.z == last.z && origin.w == last.w;
    const float most = at >= 0 ? as_float(found[at]) : emission;
    // The next power of two, so that what is relative to it is less than 1 and as exact as before.
    const float scale = most > 0.0f ? as_float(((as_uint(most) >> 23) + 1u) << 23) : 1.0f;
    const int all = source == 2 || !same || scale != state->emission;
    state->all = all;
    state->stale = all || source == 1;
    state->todo = 0;
    if (!state->stale) return;
    state->origin = origin;
    state->emission = scale;
    state->bricks = state->voxels = state->dropped = state->outside = 0;
    state->slots = slots;
}

// Bricks that a work-item looks at: one atomic for all of theirs.
#define MARK_RUN 16

// One work-item = MARK_RUN bricks: those that one of `boxes` (a node of boxes, geometry_types.h) touches are marked and listed.
__kernel void voxel_grid_mark(__global const float* boxes, int hasBoxes, int size, __global int* changed, __global int* list,
                              __global LwVoxelGrid* state) {
    const int side = size / LW_VOXEL_BRICK, first = (int)get_global_id(0) * MARK_RUN, last = min(first + MARK_RUN, side * side * side);
    if (first >= last || !(state->stale || state->marked)) return;
    const float4 origin = state->origin;
    const float cell = origin.w, half_ = cell * (0.5f * LW_VOXEL_BRICK + 0.01f);  // what touches a side is both bricks'
    int count = 0, found[MARK_RUN];
    for (int b = first; b < last; ++b) {
        int is = state->stale && (state->all || !hasBoxes);
        if (state->stale && !is) {
            const float cx = origin.x + ((float)(b % side) + 0.5f) * cell * LW_VOXEL_BRICK,
                        cy = origin.y + ((float)(b / side % side) + 0.5f) * cell * LW_VOXEL_BRICK,
                        cz = origin.z + ((float)(b / (side * side)) + 0.5f) * cell * LW_VOXEL_BRICK;
            for (int i = 0; i < LW_TREE_CHILDREN && !is; ++i)
                is = boxes[LW_TREE_HALF + i] >= 0.0f && fabs(boxes[i] - cx) <= boxes[LW_TREE_HALF + i] + half_ &&
                     fabs(boxes[16 + i] - cy) <= boxes[LW_TREE_HALF + 16 + i] + half_ &&
                     fabs(boxes[32 + i] - cz) <= boxes[LW_TREE_HALF + 32 + i] + half_;
        }
        changed[b] = is;
        if (is) found[count++] = b;
    }
    if (count == 0) return;
    const int at = atomic_add(&state->todo, count);
    for (int i = 0; i < count; ++i) list[at + i] = found[i];
}

// One work-item = LW_VOXEL_CHUNK bricks, once their bits are known: how many of them want a slot. Slots of bricks that are empty now
// are freed. Sums go to the state, which nothing else of this kernel reads.
__kernel void voxel_grid_census(__global const uint* occupied, int size, int sparse, __global int* bricks, __global int* owners,
                                __global int* chunks, __global LwVoxelGrid* state) {
    const int side = size / LW_VOXEL_BRICK, count = side * side * side, chunk = (int)get_global_id(0), first = chunk * LW_VOXEL_CHUNK;
    if (first >= count || !state->stale) return;
    int wanted = 0, full = 0, voxels = 0;
    for (int b = first; b < min(first + LW_VOXEL_CHUNK, count); ++b) {
        int inside = 0;
        for (int w = 0; w < LW_VOXEL_WORDS; ++w) inside += (int)popcount(occupied[LW_VOXEL_WORDS * b + w]);
        full += inside > 0;
        voxels += inside;
        const int slot = state->all ? LW_VOXEL_EMPTY : bricks[b], wants = inside > 0 || !sparse;
        if (slot >= 0 && !wants) owners[slot] = LW_VOXEL_EMPTY;
        if (slot < 0 || !wants) bricks[b] = LW_VOXEL_EMPTY;
        wanted += wants && slot < 0;
    }
    chunks[chunk] = wanted;
    if (full) atomic_add(&state->bricks, full);
    if (voxels) atomic_add(&state->voxels, voxels);
}

// One work-item = LW_VOXEL_CHUNK slots: how many are free.
__kernel void voxel_grid_free(__global int* owners, int slots, __global int* chunks, int firstChunk, __global const LwVoxelGrid* state) {
    const int chunk = (int)get_global_id(0), first = chunk * LW_VOXEL_CHUNK;
    if (first >= slots || !state->stale) return;
    int count = 0;
    for (int s = first; s < min(first + LW_VOXEL_CHUNK, slots); ++s) {
        if (state->all) owners[s] = LW_VOXEL_EMPTY;
        count += owners[s] < 0;
    }
    chunks[firstChunk + chunk] = count;
}

LW_FN int sum_before(__global int* chunks, int count) {
    int sum = 0;
    for (int i = 0; i < count; ++i) {
        const int own = chunks[i];
        chunks[i] = sum;
        sum += own;
    }
    return sum;
}

// One work-item in all: how many bricks want a slot, and how many slots are free, before each chunk of them.
__kernel void voxel_grid_scan(__global int* chunks, int brickChunks, int slotChunks, __global LwVoxelGrid* state) {
    if (get_global_id(0) != 0) return;
    state->marked = state->stale;
    if (!state->stale) return;
    const int wanted = sum_before(chunks, brickChunks), room = sum_before(chunks + brickChunks, slotChunks);
    state->free = room;
    state->dropped = max(wanted - room, 0);
}

// One work-item = LW_VOXEL_CHUNK slots: the free ones among them, in order.
__kernel void voxel_grid_list_free(__global const int* owners, int slots, __global const int* chunks, int firstChunk, __global int* free,
                                   __global const LwVoxelGrid* state) {
    const int chunk = (int)get_global_id(0), first = chunk * LW_VOXEL_CHUNK;
    if (first >= slots || !state->stale) return;
    int at = chunks[firstChunk + chunk];
    for (int s = first; s < min(first + LW_VOXEL_CHUNK, slots); ++s)
        if (owners[s] < 0) free[at++] = s;
}

// One work-item = LW_VOXEL_CHUNK bricks: the k-th that wants a slot gets the k-th that is free, as long as there are any. One that
// had found none before may not have been marked.
__kernel void voxel_grid_give(__global const uint* occupied, int size, int sparse, __global const int* chunks,
                              __global const int* free, __global int* bricks, __global int* owners, __global int* changed,
                              __global int* list, __global LwVoxelGrid* state) {
    const int side = size / LW_VOXEL_BRICK, count = side * side * side, chunk = (int)get_global_id(0), first = chunk * LW_VOXEL_CHUNK;
    if (first >= count || !state->stale) return;
    int at = chunks[chunk];
    for (int b = first; b < min(first + LW_VOXEL_CHUNK, count); ++b) {
        if (bricks[b] >= 0) continue;
        uint any = 0;
        for (int w = 0; w < LW_VOXEL_WORDS; ++w) any |= occupied[LW_VOXEL_WORDS * b + w];
        if (sparse && any == 0) continue;
        if (at < state->free) {
            bricks[b] = free[at];
            owners[free[at]] = b;
            if (!changed[b]) {
                changed[b] = 1;
                list[atomic_inc(&state->todo)] = b;
            }
        }
        ++at;
    }
}
