// Voxels as receivers of light, for further bounces: a list of those that hold surfaces, in the order of
// the bricks, as places with a normal that light is gathered at; and what has been gathered, brought
// back to the voxels.
//
// A receiver lies in its voxel's middle and faces as the sum of its surfaces does. Where these face both
// ways (the two sides of a thin wall: their sum is a quarter of their area at most) it faces up the axis
// that they cover most: such a voxel hears one of its sides.
#include "shared/grid_types.h"
#include "shared/voxel_mips_types.h"
#include "shared/vpl_list.h"
#include "voxel_shade.h"

// Receivers of a work-item that reads or clears a list.
#define RECEIVER_RUN 64
// Of a voxel's area, the least that faces one way for its surfaces to have a side. Larger: corners of
// rooms hear one of their walls alone. Smaller: what is left of two sheets' rounding decides.
#define RECEIVER_SIDED 0.25f

// tolerance: in voxels.
LW_FN int same_place(float4 a, float4 b, float tolerance) {
    const float4 off = fabs(a - b);
    return a.w == b.w && fmax(fmax(off.x, off.y), off.z) <= tolerance * a.w;
}

// One work-item = one brick: how many of its voxels hold surfaces.
__kernel void voxel_receivers_count(LwVoxelContents contents, __global const int* bricks,
                                    __global const float* surfaces, __global const LwVoxelWork* work,
                                    __global int* counts) {
    const int brick = lw_list_index(), side = contents.size / LW_VOXEL_BRICK;
    if (brick >= side * side * side || !work->stale) return;
    const int slot = bricks[brick];
    int count = 0;
    if (slot >= 0) {
        __global const float* area =
            surfaces + (LW_SURFACE_AREA * contents.slots + slot) * LW_VOXEL_BRICK_VOXELS;
        for (int i = 0; i < LW_VOXEL_BRICK_VOXELS; i += LW_WIDTH) count += count_(load(area, i) > 0.0f);
    }
    counts[brick] = count;
}

// One work-item in all: each brick's first receiver. last: where the grid lay when the list was made; tolerance: by how many voxels it
// may be off that and be the same.
__kernel void voxel_receivers_scan(__global const LwGridPlace* grid, __global float4* last, int bricks,
                                   int room, int all, float tolerance, __global const LwVoxelWork* work,
                                   __global int* counts, __global LwVoxelReceivers* state) {
    if (get_global_id(0) != 0) return;
    const float4 place = (float4)(grid->origin.xyz, grid->cell.x);
    const int isSame = same_place(*last, place, tolerance);
    *last = place;  // also where nothing is stale: a scene that moves along with the origin of positions stays where it is
    if (!work->stale) return;
    int sum = 0;
    for (int i = 0; i < bricks; ++i) {
        const int count = counts[i];
        counts[i] = sum;
        sum += count;
    }
    state->receivers = min(sum, room);
    state->missing = sum - min(sum, room);
    state->moved = all || !isSame;
}

// One work-item = one brick: its receivers. What its voxels have heard is forgotten where they hold
// nothing any more, or where the slot's brick or the grid's place is another.
__kernel void voxel_receivers_list(__global const LwGridPlace* grid, LwVoxelContents contents,
                                   __global const int* bricks, __global const float* surfaces,
                                   __global const LwVoxelWork* work, __global const int* counts,
                                   int room, __global const LwVoxelReceivers* state,
                                   __global int* before, __global float* heard, __global float* points,
                                   __global int* voxels) {
    const int brick = lw_list_index(), side = contents.size / LW_VOXEL_BRICK;
    if (brick >= side * side * side || !work->stale) return;
    const int slot = bricks[brick], plane = contents.slots * LW_VOXEL_BRICK_VOXELS,
              isOther = state->moved || before[brick] != slot;
    before[brick] = slot;
    if (slot < 0) return;
    const LwGridPlace place = *grid;
    __global const uint* normals = (__global const uint*)surfaces + LW_SURFACE_NORMAL * plane;
    int to = counts[brick];
    for (int i = 0; i < LW_VOXEL_BRICK_VOXELS; ++i) {
        const int at = slot * LW_VOXEL_BRICK_VOXELS + i;
        const int has = surfaces[LW_SURFACE_AREA * plane + at] > 0.0f;
        if (isOther || !has)
            for (int c = 0; c < 3; ++c) heard[c * plane + at] = 0.0f;
        if (!has) continue;
        if (to >= room) break;
        const uint word = normals[at];
        float n[3];
        for (int a = 0; a < 3; ++a)
            n[a] = ((float)(int)(word >> (10 * a) & 1023u) - 511.0f) * (1.0f / 511.0f);
        const float length_ = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length_ > RECEIVER_SIDED) {
            for (int a = 0; a < 3; ++a) n[a] /= length_;
        } else {
            const float x = surfaces[at], y = surfaces[plane + at], z = surfaces[2 * plane + at];
            n[0] = x >= y && x >= z;
            n[1] = !(x >= y && x >= z) && y >= z;
            n[2] = !(x >= y && x >= z) && !(y >= z);
        }
        const float middle[3] = {(float)(8 * (brick % side) + (i & 7)) + 0.5f,
                                 (float)(8 * (brick / side % side) + (i >> 3 & 7)) + 0.5f,
                                 (float)(8 * (brick / (side * side)) + (i >> 6)) + 0.5f};
        points[to] = place.origin.x + place.cell.x * middle[0];
        points[room + to] = place.origin.y + place.cell.x * middle[1];
        points[2 * room + to] = place.origin.z + place.cell.x * middle[2];
        for (int a = 0; a < 3; ++a) points[(3 + a) * room + to] = n[a];
        voxels[to++] = at;
    }
}

// One work-item = RECEIVER_RUN places of the list: those behind the last receiver are none.
__kernel void voxel_receivers_end(int room, __global const LwVoxelWork* work,
                                  __global const LwVoxelReceivers* state, __global float* points) {
    const int first = lw_list_index() * RECEIVER_RUN;
    if (first >= room || !work->stale) return;
    for (int i = max(first, state->receivers); i < min(first + RECEIVER_RUN, room); ++i)
        for (int p = 0; p < 6; ++p) points[p * room + i] = 0.0f;
}

// One work-item = RECEIVER_RUN receivers: what has been gathered there, to their voxels. Marks slots
// where it is something else.
__kernel void voxel_receivers_hear(__global const float* gathered, int room,
                                   __global const LwVoxelReceivers* state, __global const int* voxels,
                                   int plane, __global float* heard, __global int* touched) {
    const int first = lw_list_index() * RECEIVER_RUN;
    for (int i = first; i < min(first + RECEIVER_RUN, state->receivers); ++i) {
        const int at = voxels[i];
        int differs = 0;
        for (int c = 0; c < 3; ++c) {
            const float value = gathered[c * room + i];
            differs |= as_int(value) != as_int(heard[c * plane + at]);
            heard[c * plane + at] = value;
        }
        if (differs) atomic_or(touched + at / LW_VOXEL_BRICK_VOXELS, LW_LIGHT_HEARD);
    }
}
