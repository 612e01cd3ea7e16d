// Surfels in bins of a grid's bricks, and as octagons (kernels/voxel_grid).
#ifndef LW_VOXEL_BINS_H
#define LW_VOXEL_BINS_H

#include "lpv_types.h"
#include "surfel_types.h"
#include "voxel_types.h"

LW_FN lw_int bin_side(lw_int size) { return size / LW_VOXEL_BRICK + 2; }
LW_FN lw_int large_bin(lw_int size) { return bin_side(size) * bin_side(size) * bin_side(size); }
// Two lists of each bin.
LW_FN lw_int bin_lists(lw_int size) { return 2 * (large_bin(size) + 1); }

// Discs of a smaller radius, in voxels, are put into their centre's voxel whole: their rim is less than half a voxel beyond it. Less:
// time for what a voxel does not show; more: surfaces end up to so far off.
#define SURFEL_SMALL 0.5f
// Discs that reach farther than this, in voxels, are every brick's to look at. No more than a brick: less than that reaches the bricks
// around its own alone.
#define LARGE_REACH 7.9f
// Radius about an octagon of the area of a disc of radius 1: 4 sin(45 degrees) R^2 = pi.
#define OCTAGON_REACH 1.0539073f

#endif
