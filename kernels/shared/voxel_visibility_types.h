// How far points see the voxels of a grid, as kernels and host share it.
#ifndef LW_VOXEL_VISIBILITY_TYPES_H
#define LW_VOXEL_VISIBILITY_TYPES_H

#include "portable.h"

// A byte for each voxel and eye: in the low bits the share of the eye's light that reaches the voxel, whether or not something
// lies in the voxel; with the highest bit set, something does, and nothing goes on from there.
#define LW_SIGHT_FULL 127
#define LW_SIGHT_SOLID 128
// Bytes before the first voxel and after the last: loads of a row reach one voxel beyond its ends.
#define LW_SIGHT_PAD 64
// Weight of a voxel that holds something among the eight that a receiver interpolates, to that of an empty one: it only counts
// where all eight do. More: light of a wall's lit side comes through, as much of it as this is; by 2^-14 under 1e-3 even where
// the empty ones have a hundredth of the weight.
#define LW_SIGHT_SOLID_WEIGHT 6.103515625e-5f

// Rows of a shell that one work-item sweeps. Less: eyes at rest cost more, a work-item each that finds nothing to do.
#define LW_SWEEP_ROWS 4

typedef struct {
    lw_float4 position;  // in voxels from the grid's corner; w: 1; 0: nothing shadows its light (not in the grid, or no light)
    lw_int4 sweep;       // x: 1 in a frame that works its voxels out anew
} LwVoxelEye;
LW_SIZE_CHECK(LwVoxelEye, 32);

typedef struct {
    lw_float4 origin;  // of the grid, as LwGridPlace's: w: voxels to a unit of length, 0: there is no grid
    lw_int size;       // voxels a side
    lw_int changed;    // 1: other voxels hold something than in the frame before
    lw_int swept;      // eyes that this frame works out anew
    lw_int spare;
} LwVoxelSight;
LW_SIZE_CHECK(LwVoxelSight, 32);

// Voxels along the normal that eyes and receivers stand off their surface: |n.x| + |n.y| + |n.z|, from 1 to sqrt(3). A voxel's
// centre lies within half of it of a plane that touches the voxel, and a voxel that is interpolated within all of it of the
// place that asks. So the voxel that holds the place does not touch the surface's plane, and none of the eight lies behind it.
// Less: surfaces shadow themselves. More: what stands nearer to a surface than this casts no shadow on it.
LW_FN lw_float sight_clearance(lw_float x, lw_float y, lw_float z) {
    return (x < 0.0f ? -x : x) + (y < 0.0f ? -y : y) + (z < 0.0f ? -z : z);
}

#endif
