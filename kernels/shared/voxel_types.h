// The scene as voxels (Crassin et al. 2011): how grids, their bricks and their levels lie in memory.
//
// A grid has `size` voxels a side, and levels of half as many each down to one. Voxels come in bricks, and only bricks that hold
// something have memory: a table says for each brick of each level in which slot it lies, or that it is empty.
#ifndef LW_VOXEL_TYPES_H
#define LW_VOXEL_TYPES_H

#include "portable.h"

// Voxels a side of a brick. Less: larger tables, more of a brick is apron; more: more of a brick is empty.
#define LW_VOXEL_BRICK 8
#define LW_VOXEL_BRICK_VOXELS 512
// Of a brick that is sampled, voxels a side in memory: beyond its own those of the next bricks that it is interpolated with.
#define LW_VOXEL_STORED 9
#define LW_VOXEL_STORED_VOXELS 729
// Words that a brick begins after the one before: whole cache lines.
#define LW_VOXEL_STRIDE 736

#define LW_VOXEL_EMPTY (-1)

// Levels of a grid, voxels and bricks a side of one, and where a level's bricks begin in the grid's table.
LW_FN lw_int voxel_levels(lw_int size) {
    lw_int levels = 1;
    for (; size > 1; size >>= 1) ++levels;
    return levels;
}
LW_FN lw_int voxel_side(lw_int size, lw_int level) { return size >> level; }
LW_FN lw_int voxel_bricks(lw_int size, lw_int level) {
    return size >> level > LW_VOXEL_BRICK ? (size >> level) / LW_VOXEL_BRICK : 1;
}
LW_FN lw_int voxel_table(lw_int size, lw_int level) {
    lw_int first = 0;
    for (lw_int l = 0; l < level; ++l) first += voxel_bricks(size, l) * voxel_bricks(size, l) * voxel_bricks(size, l);
    return first;
}
LW_FN lw_int voxel_table_size(lw_int size) { return voxel_table(size, voxel_levels(size)); }

// Of one voxel of the finest level, before there is light: planes of words, each of slots x LW_VOXEL_BRICK_VOXELS, voxels of a
// brick in the order x, y, z. Areas are in faces of a voxel, as many as there are surfaces (above 1 where several lie in it).
#define LW_SURFACE_AREA_X 0    // float: sum of A |n.x|
#define LW_SURFACE_AREA_Y 1
#define LW_SURFACE_AREA_Z 2
#define LW_SURFACE_AREA 3      // float: sum of A
#define LW_SURFACE_NORMAL 4    // packed: sum of A n over sum of A, n as the host's triangles or surfels face (three of 10 bits)
#define LW_SURFACE_ALBEDO 5    // packed: mean by area (three of 10 bits)
#define LW_SURFACE_EMISSION 6  // packed: mean by area (shared exponent, three of 9 bits)
#define LW_SURFACE_PLANES 7

// Words of a voxel that cones read. Finest level: isotropic one, or six sides with directional opacity; SH2 four. Above: isotropic
// one, anisotropic six, SH2 four.
#define LW_VOXEL_SIDES 6       // -x, +x, -y, +y, -z, +z: what is seen by a ray that goes that way
#define LW_VOXEL_HARMONICS 4

#endif
