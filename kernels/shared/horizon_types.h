// The pattern of the horizon gather, as kernels and host agree on it (kernels/horizon_gather).
#ifndef LW_HORIZON_TYPES_H
#define LW_HORIZON_TYPES_H

#include "portable.h"

// Levels of the pyramid that a gather may read, the one that it runs on included.
#define LW_HORIZON_LEVELS 12

// Sectors of a slice: bits of a word but one, since borders are made by shifts, and one by all 32 would be one by 0.
#define LW_HORIZON_SECTORS 31

// On coarse levels the pixels of an 8 x 8 pattern look up texels shifted by up to half a texel, in steps of an eighth, across
// and down, each pair of shifts once, and every shift once in any eight columns of a row: the mean over eight columns is what
// interpolation between texels would give. Without it the squares of coarse texels show; with steps of quarters they do on
// surfaces far from what sends. LW_HORIZON_BLEND: the first level on which a step of it is a pixel. Halves of such steps:
#define LW_HORIZON_BLEND 3
LW_FN lw_int lw_horizon_column(lw_int x) { return 2 * (x & 7) - 7; }
LW_FN lw_int lw_horizon_row(lw_int x, lw_int y) { return 2 * ((3 * x + 5 * y) & 7) - 7; }

// A line through the pixel, walked to both sides.
typedef struct {
    lw_float dx, dy;     // unit vector in the image, +x right, +y down
    lw_float share;      // of all directions in the image that the slice stands for: they sum to 1
    lw_float rounding;   // in (0, 1): sector borders are rounded down after adding it
    lw_int first[2];     // step of each side in the table of steps: along (dx, dy), and against it
    lw_int steps;        // a side has
    lw_int reserved;
} lw_horizon_slice;
LW_SIZE_CHECK(lw_horizon_slice, 32);

// Where a slice is looked at: texel ((x + phaseX) >> level) + dx, and the same for rows; from level LW_HORIZON_BLEND on with
// the pixel's own shift, (lw_horizon_column, lw_horizon_row) << (level - 3) >> 1, added. What it shows stands for the line
// from `begin` to `end`.
typedef struct {
    lw_int dx, dy;
    lw_int level;               // above the one that the gather runs on
    lw_int phaseX, phaseY;      // pixels of that one
    lw_float begin, end;        // distances in pixels of the full image
    lw_int columns, rows;       // of the level
    lw_int first, rowStride, planeStride;  // its layout, in floats
    lw_int reserved0, reserved1, reserved2, reserved3;
} lw_horizon_step;
LW_SIZE_CHECK(lw_horizon_step, 64);

typedef struct {
    lw_float4 eye;   // xyz; w: 1 perspective, 0 orthographic
    lw_float4 axis;  // xyz: unit, along which depth grows; w: radius of ambient occlusion, in image heights
    lw_float4 perI;  // xyz: what one column to the right adds to a ray; w: thickness, as a share of the depth (orthographic: a length)
    lw_float4 perJ;  // xyz: what one row down adds to a ray; w: the image's height at distance 1 (orthographic: anywhere)
    lw_int slices;   // a row of pixels looks at
    lw_int rows;     // that share out the slices
    lw_int turn;     // of the pattern: which rows take which slices, and which pixels which shifts
    lw_float rounding;  // added to the slices', in [0, 0.9)
} lw_horizon_view;
LW_SIZE_CHECK(lw_horizon_view, 80);

#endif
