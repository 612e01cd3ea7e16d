// Discrete ordinates by sweeps over a light propagation volume's grid: what kernels and host share.
//
// What surfaces in a cell send, and what they cover, depends on the direction through their normals: max(0, n.d) and |n.d|.
// Both are kept for normals of a fixed set, the 26 with coordinates of -1, 0 and 1 normalised. A normal whose coordinates are
// a >= b >= c by size is (a - b) times that of its axis, sqrt(2) (b - c) times that of the edge and sqrt(3) c times that of the
// corner next to it, exactly; so n.d is exact for every d that lies on the same side of the three planes as of n's own.
#ifndef LW_LPV_SWEEP_TYPES_H
#define LW_LPV_SWEEP_TYPES_H

#include "lpv_types.h"

#define LW_SWEEP_COLOURS 3
// Normals: number of (x, y, z) is (x + 1) + 3 (y + 1) + 9 (z + 1), one less beyond 13, which would be (0, 0, 0). -n is 25 - n.
#define LW_SWEEP_NORMALS 26
#define LW_SWEEP_SOURCES (LW_SWEEP_NORMALS * LW_SWEEP_COLOURS)
// Sheets: normals without their sign, the lower number of the two. Beside them what they cover of the cell, seen along an axis.
#define LW_SWEEP_SHEETS 13
#define LW_SWEEP_COVER LW_SWEEP_SHEETS
#define LW_SWEEP_BLOCKS (LW_SWEEP_SHEETS + 1)
// Of a surfel's area no more than so many sides of a cell count, which is 16 times what closes one. It keeps the sums, in units of
// 2^-LW_SWEEP_AREA_BITS, far from overflow.
#define LW_SWEEP_MOST_AREA 16.0f
#define LW_SWEEP_AREA_BITS 30

// Directions of one dominant axis and one octant form a group; number 8 axis + octant, a bit of which is 1 where d is positive
// along x (1), y (2), z (4).
#define LW_SWEEP_GROUPS 24
// Sides of cells, by what faces them: normals +x, -x, +y, -y, +z, -z.
#define LW_SWEEP_SIDES 6
// What a group leaves of its light in a cell: for each axis and colour the sum of w L |d.axis|.
#define LW_SWEEP_PARTS (3 * LW_SWEEP_COLOURS)

// A direction's numbers. Shares of the four cells of the plane before: the same lane and row, the lane before, the row before,
// both; then w |d.axis| of the three axes; then for each normal max(0, n.d) / (pi |d_a|), for each sheet |n.d| / |d_a|.
#define LW_SWEEP_SHARES 0
#define LW_SWEEP_WEIGHTS 4
#define LW_SWEEP_SEND 7
#define LW_SWEEP_STOP (LW_SWEEP_SEND + LW_SWEEP_NORMALS)
#define LW_SWEEP_DIRECTION (LW_SWEEP_STOP + LW_SWEEP_SHEETS)

// Floats of a cell as pixels read it: red, green, blue of each side and how open the cell is, light multiplied by that; rounded up
// so that vectors are aligned.
#define LW_SWEEP_CELL 32

// Cells lie in memory twice: lanes along x (rows along y, slices along z), and lanes along y (rows along x, slices along z), for
// directions whose dominant axis is x. Numbers of cells to the next row and plane of a sweep: along z size and size^2, in the first
// order; along y size^2 and size, in the first; along x the same in the second.
#define LW_SWEEP_ORDERS 2

// Sums of light and of area, two words each, cell by cell; behind them a word for each cell, a bit of which is 1 where it has
// light of a normal, or area of a sheet: most have of one or two.
LW_FN lw_int sweep_light_marks(lw_int size) { return 2 * LW_SWEEP_SOURCES * size * size * size; }
LW_FN lw_int sweep_area_marks(lw_int size) { return 2 * LW_SWEEP_BLOCKS * size * size * size; }

// What the cover of the cells was made of, and whether that has changed.
typedef struct {
    lw_float4 origin;     // LwLpvPlace's
    lw_uint revision[2];  // of the surfels
    lw_int stale, unused;
    LwLpvParts parts;
} LwSweepCover;
LW_SIZE_CHECK(LwSweepCover, 176);

// A plane's light, between empty cells on all sides.
#define LW_SWEEP_PAD 16
LW_FN lw_int sweep_row(lw_int size) { return size + LW_SWEEP_PAD; }
LW_FN lw_int sweep_plane(lw_int size) { return LW_SWEEP_PAD + sweep_row(size) * (size + 2); }

#endif
