// Light propagation volumes (Kaplanyan and Dachsbacher 2010): how a grid lies in memory, where it lies in the world, and
// the constants of its spherical harmonics.
//
// A colour's light in a cell is radiant intensity in two bands, I(d) = Y0 c0 + Y1 (c1 . d) in W/sr: four planes of floats for
// each colour, c0, c1.x, c1.y, c1.z.
#ifndef LW_LPV_TYPES_H
#define LW_LPV_TYPES_H

#include "grid_types.h"
#include "portable.h"

#define LW_LPV_COLOURS 3
#define LW_LPV_BANDS 4
#define LW_LPV_PLANES (LW_LPV_COLOURS * LW_LPV_BANDS)

// For the host, in double; kernels have them as floats.
// Y0 = 1 / (2 sqrt(pi)), Y1 = sqrt(3 / (4 pi)); the cosine lobe max(0, n.d) is LOBE0 Y0 + LOBE1 Y1 (n.d).
#define LW_LPV_Y0 0.2820947917738781
#define LW_LPV_Y1 0.4886025119029199
#define LW_LPV_LOBE0 0.8862269254527579  // sqrt(pi) / 2
#define LW_LPV_LOBE1 1.0233267079464885  // sqrt(pi / 3)

// Solid angles of a cell's five far faces from the centre of the neighbour: 4 asin(1/10), and a quarter of what is missing of
// a sixth of the sphere's 4 pi. With the widely copied 0.4234413544 for the side faces each step makes 1.9e-5 of light.
#define LW_LPV_FRONT_ANGLE 0.4006696846462392
#define LW_LPV_SIDE_ANGLE 0.423431354436739

// Empty cells between the rows of a plane, which thus are each row's border on both sides; as many before the first.
#define LW_LPV_PAD 16

// Floats from a row, from a slice to the next, and of a plane: rows of a slice and slices have an empty one before and after.
LW_FN lw_int lpv_row(lw_int size) { return size + LW_LPV_PAD; }
LW_FN lw_int lpv_slice(lw_int size) { return lpv_row(size) * (size + 2); }
LW_FN lw_int lpv_plane(lw_int size) { return LW_LPV_PAD + lpv_slice(size) * (size + 2); }
LW_FN lw_int lpv_cell(lw_int size, lw_int x, lw_int y, lw_int z) {
    return LW_LPV_PAD + x + (y + 1) * lpv_row(size) + (z + 1) * lpv_slice(size);
}

typedef LwGridPlace LwLpvPlace;

// Of the volume that blocks: what gets through the faces between cells, planes laid out as those of light. Light of one cell that
// reaches a neighbour along axis a leaves it through five far faces, and has five ways through the face between the two: straight
// on, and towards the sides +u, -u, +v, -v, where u and v are the other axes in the order x, y, z. Plane 5 a + w at a cell: of its
// face towards the lower neighbour, for way w of light that goes up. Light that goes down takes the same ways backwards: its
// +u is way -u.
#define LW_LPV_WAYS 5
#define LW_LPV_FACE_PLANES (3 * LW_LPV_WAYS)
// Blockers are kept at the cells' corners, half a cell off; corners of a grid.
LW_FN lw_int lpv_corners(lw_int size) { return (size + 1) * (size + 1) * (size + 1); }
// Cells of a row that are told together whether anything blocks about them, at every width.
#define LW_LPV_BLOCK_RUN 16

// What of a grid that moved is to be made, see lpv_scroll.h: boxes of cells or corners that do not overlap; where cell (0, 0, 0) is kept;
// and the others' shift: cell i was cell i + shift.
#define LW_LPV_PARTS 3
typedef struct {
    lw_int4 low[LW_LPV_PARTS], high[LW_LPV_PARTS];  // xyz; high: beyond the last
    lw_int4 slot, shift;                            // xyz
    lw_int count, unused[3];                        // boxes; 0: all is right
} LwLpvParts;
LW_SIZE_CHECK(LwLpvParts, 144);

// What the corners' blockers were made of, and whether that has changed.
typedef struct {
    lw_float4 origin;              // LwLpvPlace's
    lw_uint revision[2];           // of the surfels
    lw_int stale, surfelsOutside;  // surfels that no corner of the grid is nearest to
    LwLpvParts parts;
    lw_int current, unused[3];  // which of two arrays of corners holds them
} LwLpvBlockers;
LW_SIZE_CHECK(LwLpvBlockers, 192);

// Radiance from infinity above which it is refused. What it sends through a cell's side stays finite in all of a grid (cells of 1e8
// units, which positions allow for: 1e36), and no sky comes near it: the sun's disc has 2e7 W/m^2/sr.
#define LW_LPV_LARGEST_ENVIRONMENT 1e20f

// How far steps have come that stop by what is left to do: looked at every LW_LPV_LOOK of them.
#define LW_LPV_LOOK 8
typedef struct {
    lw_int done, steps;  // 1: no more steps; that were taken
    float moving;        // of the light put in, what the last of them moved: the largest share of a colour
    float scale;         // of what is read: calibration of these steps by that of all
} LwLpvProgress;
LW_SIZE_CHECK(LwLpvProgress, 16);

#define LW_LPV_OUTSIDE LW_GRID_OUTSIDE  // of a grid's state: texels and VPLs with flux that no cell takes

#endif
