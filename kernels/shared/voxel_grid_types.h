// What pass voxel_grid knows of its bricks between frames (src/passes/voxel_grid.h).
#ifndef LW_VOXEL_GRID_TYPES_H
#define LW_VOXEL_GRID_TYPES_H

#include "voxel_types.h"

// Of the bits that say which voxels of a brick are occupied: bit = x + 8 y + 64 z, lowest bits of lower words first.
#define LW_VOXEL_WORDS (LW_VOXEL_BRICK_VOXELS / 32)

typedef struct {
    lw_float4 origin;    // LwLpvPlace's; w: a cell's side, 0: no grid
    lw_int stale, all;   // 1: this record changes bricks; all of them
    lw_int todo;         // bricks on the list of those that are made anew
    lw_int marked;       // 1: some brick is marked as changed
    lw_int bricks, voxels;  // that are occupied, of all
    lw_int dropped;      // bricks that have found no slot: their surfaces are lost, not their occupied bits
    lw_int outside;      // triangles or surfels that lie beyond the grid wholly
    lw_float emission;   // what LW_SURFACE_EMISSION is relative to: a power of two
    lw_int slots;        // that there is room for
    lw_int free;         // slots without a brick, before the last bricks found theirs
    lw_int unused;
} LwVoxelGrid;
LW_SIZE_CHECK(LwVoxelGrid, 64);

// Bricks, and slots, that one work-item counts.
#define LW_VOXEL_CHUNK 64

#endif
