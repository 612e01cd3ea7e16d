// What passes voxel_mips and voxel_light tell each other about one grid of voxels
// (src/passes/voxel_mips.h).
#ifndef LW_VOXEL_MIPS_TYPES_H
#define LW_VOXEL_MIPS_TYPES_H

#include "voxel_format.h"

#define LW_VOXEL_BRICK_WORDS \
    (LW_VOXEL_BRICK_VOXELS / 32)  // of bits that say which voxels may hold something
#define LW_VOXEL_RUN 64           // bricks that one work-item counts

typedef struct {
    lw_int stale;       // 1: some brick's surfaces are others than those that the tables were made of
    lw_int moved;       // 1: some brick's slot is another: all words are written anew
    lw_int baseWanted;  // slots, with those that there was no room for
    lw_int mipsWanted;
} LwVoxelWork;
LW_SIZE_CHECK(LwVoxelWork, 16);

// One level as it is filtered from the one below. Places are in the table, and in the marks of changed
// bricks, which hold one grid.
typedef struct {
    lw_int fineTable, table, fineMarks, marks;
    lw_int fineSide, side;         // bricks a side
    lw_int fineFirst;              // words before the first plane that is read
    lw_int finePlane, plane;       // words of a plane; finePlane 0: one plane for all sides
    lw_int voxels, level, unused;  // a side
} LwVoxelFilter;
LW_SIZE_CHECK(LwVoxelFilter, 48);

#endif
