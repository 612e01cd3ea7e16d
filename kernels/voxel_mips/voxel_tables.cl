// Which bricks of a grid's levels have memory (kernels/shared/voxel_types.h): those of which one of the
// 9^3 voxels that they store may hold something, their own or one of the first layers of their upper
// neighbours.
//
// A voxel of a coarser level may hold something where one of its eight children may. Slots go to bricks
// in the table's order, by counts of runs of bricks that one work-item adds up, so that they are the
// same whatever the order of work.
#include "shared/voxel_mips_types.h"

// One work-item = LW_VOXEL_RUN bricks of the finest level: is any of them new?
__kernel void voxel_tables_look(__global const int* changed, int bricks, int all,
                                __global LwVoxelWork* work) {
    const int first = (int)get_global_id(0) * LW_VOXEL_RUN;
    if (first >= bricks) return;
    int any_ = all;
    for (int i = first; i < min(first + LW_VOXEL_RUN, bricks); ++i) any_ |= changed[i];
    if (any_) atomic_or(&work->stale, 1);
    if (all) atomic_or(&work->moved, 1);
}

// Of the 32 bits of four rows of eight voxels: one bit for each two voxels of a row, at bits 0..3 of
// each byte.
LW_FN uint halved_rows(uint bits) {
    const uint pairs = (bits | bits >> 1) & 0x55555555u;
    const uint twos = (pairs | pairs >> 1) & 0x33333333u;
    return (twos | twos >> 2) & 0x0f0f0f0fu;
}

// One work-item = one brick of a level above the finest. fine: bits of the level below from brick
// fineFirst on; `side` bricks a side of this level, fineSide of that one.
__kernel void voxel_tables_occupy(__global const uint* fine, int fineFirst, int fineSide, int side,
                                  int firstBrick, __global const LwVoxelWork* work,
                                  __global uint* coarse) {
    const int brick = (int)get_global_id(0);
    if (brick >= side * side * side || !work->stale) return;
    uint bits[LW_VOXEL_BRICK_WORDS];
    for (int i = 0; i < LW_VOXEL_BRICK_WORDS; ++i) bits[i] = 0u;
    const int bx = brick % side, by = brick / side % side, bz = brick / (side * side);
    // A level of one brick has one child at most, whose voxels lie at its lower corner.
    for (int octant = 0; octant < (fineSide > 1 ? 8 : 1); ++octant) {
        const int ox = octant & 1, oy = octant >> 1 & 1, oz = octant >> 2;
        __global const uint* child =
            fine + LW_VOXEL_BRICK_WORDS *
                       (fineFirst + ((2 * bz + oz) * fineSide + 2 * by + oy) * fineSide + 2 * bx + ox);
        for (int z = 0; z < 4; ++z) {
            const uint rows[2] = {child[4 * z] | child[4 * z + 2], child[4 * z + 1] | child[4 * z + 3]};
            for (int pair = 0; pair < 2; ++pair) {
                const uint halved = halved_rows(rows[pair]);
                const uint even = (halved | halved >> 8) & 0xfu,
                           odd = (halved >> 16 | halved >> 24) & 0xfu;
                // Rows 2 pair and 2 pair + 1 of the octant's four.
                const uint both = even | odd << 8;
                bits[2 * (4 * oz + z) + oy] |= both << (16 * pair + 4 * ox);
            }
        }
    }
    __global uint* to = coarse + LW_VOXEL_BRICK_WORDS * (firstBrick + brick);
    for (int i = 0; i < LW_VOXEL_BRICK_WORDS; ++i) to[i] = bits[i];
}

// Does the neighbour `towards` (bits 0, 1, 2: one brick further along x, y, z) of a brick hold something
// that the brick stores?
LW_FN int holds(__global const uint* bits, int side, int x, int y, int z, int towards) {
    x += towards & 1;
    y += towards >> 1 & 1;
    z += towards >> 2;
    if (x >= side || y >= side || z >= side) return 0;
    __global const uint* brick = bits + LW_VOXEL_BRICK_WORDS * ((z * side + y) * side + x);
    // Of a row its first voxel, of a slice its first row, of a brick its first slice.
    const uint rows = towards & 1 ? 0x01010101u : 0xffffffffu;
    const uint first = towards & 2 ? rows & 0xffu : rows, second = towards & 2 ? 0u : rows;
    uint any_ = 0u;
    for (int slice = 0; slice < (towards & 4 ? 1 : 8); ++slice)
        any_ |= (brick[2 * slice] & first) | (brick[2 * slice + 1] & second);
    return any_ != 0u;
}

// One work-item = LW_VOXEL_RUN bricks of one level, of `side` a side: which want memory, and how many.
// all: every one.
__kernel void voxel_tables_count(__global const uint* bits, int firstBits, int side, int all,
                                 int firstBrick, int firstRun, __global const LwVoxelWork* work,
                                 __global uchar* wanted, __global int* counts) {
    const int run = (int)get_global_id(0), first = run * LW_VOXEL_RUN, bricks = side * side * side;
    if (first >= bricks || !work->stale) return;
    int count = 0;
    for (int i = first; i < min(first + LW_VOXEL_RUN, bricks); ++i) {
        const int x = i % side, y = i / side % side, z = i / (side * side);
        int wants = all;
        for (int towards = 0; towards < 8 && !wants; ++towards)
            wants = holds(bits + LW_VOXEL_BRICK_WORDS * firstBits, side, x, y, z, towards);
        wanted[firstBrick + i] = (uchar)wants;
        count += wants;
    }
    counts[firstRun + run] = count;
}

// One work-item in all: each run's first slot. Runs from `baseRuns` on are those of coarser levels, with
// slots of their own.
__kernel void voxel_tables_scan(__global int* counts, int baseRuns, int runs, int baseRoom, int mipRoom,
                                __global LwVoxelWork* work, __global LwVoxelState* states, int grid) {
    if (get_global_id(0) != 0 || !work->stale) return;
    __global LwVoxelState* state = states + grid;
    int base = 0, mips = 0;
    for (int i = 0; i < runs; ++i) {
        const int count = counts[i];
        counts[i] = i < baseRuns ? base : mips;
        if (i < baseRuns)
            base += count;
        else
            mips += count;
    }
    work->baseWanted = base;
    work->mipsWanted = mips;
    state->baseBricks = min(base, baseRoom);
    state->mipBricks = min(mips, mipRoom);
    state->droppedBricks = max(base - baseRoom, 0) + max(mips - mipRoom, 0);
}

// One work-item = LW_VOXEL_RUN bricks of one level: their slots, of `room` from `firstSlot` on.
__kernel void voxel_tables_assign(__global const uchar* wanted, int firstBrick, int bricks,
                                  __global const int* counts, int firstRun, int firstSlot, int room,
                                  __global LwVoxelWork* work, int firstEntry, __global int* table) {
    const int run = (int)get_global_id(0), first = run * LW_VOXEL_RUN;
    if (first >= bricks || !work->stale) return;
    int slot = counts[firstRun + run], moved = 0;
    for (int i = first; i < min(first + LW_VOXEL_RUN, bricks); ++i) {
        const int wants = wanted[firstBrick + i],
                  given = wants && slot < room ? firstSlot + slot : LW_VOXEL_EMPTY;
        slot += wants;
        moved |= table[firstEntry + i] != given;
        table[firstEntry + i] = given;
    }
    if (moved) atomic_or(&work->moved, 1);
}
