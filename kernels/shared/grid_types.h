// Grids of cubic cells over the world: where one lies, and how a frame wants it placed.
#ifndef LW_GRID_TYPES_H
#define LW_GRID_TYPES_H

#include "portable.h"

typedef struct {
    lw_float4 origin;  // xyz: lower corner of cell (0, 0, 0); w: cells to a unit of length; 0: there is no grid
    // x: a cell's side. y, z: powers of two whose product takes light in units of the frame's (W/sr, W) to whole numbers, two of
    // them so that neither leaves float's range.
    lw_float4 cell;
} LwGridPlace;
LW_SIZE_CHECK(LwGridPlace, 32);

typedef struct {
    lw_float4 centre;     // xyz; w: length of the grid's sides; 0: fitted to what the RSMs see, the VPLs and the box below
    lw_float4 low, high;  // xyz: a box to fit to as well; low.w: 1 where there is one
    lw_float4 stepHigh, stepLow, stepLeast;  // xyz: from the world's origin to that of positions, in three parts
    lw_int refit;         // 1: whatever the last frame's grid was
    lw_int bits;          // of the largest whole number that one texel's light may make
    lw_int size;
    lw_int unit;          // with an extent, cells that the grid's corner is at multiples of; 0: wherever it is
} LwGridFit;
LW_SIZE_CHECK(LwGridFit, 112);

// What is known of a frame's light before the grid is placed; the bounds as keys that order as the numbers do.
#define LW_GRID_LOW 0      // three: of the negated coordinates
#define LW_GRID_HIGH 3     // three
#define LW_GRID_LARGEST 6  // bits of the largest flux of a colour
#define LW_GRID_OUTSIDE 7  // texels and VPLs with flux that no cell takes, for who puts them into cells
#define LW_GRID_STATE 8

#endif
