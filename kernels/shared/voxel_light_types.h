// What pass voxel_light keeps of the light in one grid's voxels (src/passes/voxel_light.h).
#ifndef LW_VOXEL_LIGHT_TYPES_H
#define LW_VOXEL_LIGHT_TYPES_H

#include "voxel_format.h"

// Planes of sums, and of what they come to, for each slot of surfaces. A slot's sums: [plane][lower,
// upper half][voxel].
#define LW_LIGHT_FLUX 0  // of three colours
#define LW_LIGHT_DIRECTION \
    3  // three: sum over texels of the colours' flux times the normal; where a volume tells sides apart
#define LW_VOXEL_LIGHT_PLANES 6

// How words are made of surfaces and light.
typedef struct {
    lw_int mode;      // LWVoxelMode
    lw_int sides;     // 1: six sides on the finest level
    lw_int aware;     // 1: of what faces them
    lw_int feedback;  // 1: of light that arrives at receivers as well
    lw_int size;
    lw_int slots;       // of surfaces
    lw_int planeWords;  // of the finest level's words
    lw_int planes;      // of sums: LW_VOXEL_LIGHT_PLANES, or 3 without directions
} LwVoxelContents;
LW_SIZE_CHECK(LwVoxelContents, 32);

// Marks of each slot.
#define LW_LIGHT_TOUCHED 1  // texels of this frame lie in it
#define LW_LIGHT_LIT 2      // it held light when it was last settled
#define LW_LIGHT_HEARD 4    // what arrives at its receivers has changed

// What befell the frame's texels.
typedef struct {
    lw_int outside;  // texels with flux that lie beyond the grid
    lw_int lost;     // that lie in it where no surface has become a voxel
} LwVoxelTexels;
LW_SIZE_CHECK(LwVoxelTexels, 8);

// Voxels that hear, for further bounces.
typedef struct {
    lw_int receivers;  // on the list
    lw_int missing;    // that the list has no room for
    lw_int moved;      // 1: the grid lies elsewhere than when they last heard
    lw_int unused;
} LwVoxelReceivers;
LW_SIZE_CHECK(LwVoxelReceivers, 16);

#endif
