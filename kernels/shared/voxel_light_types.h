// What pass voxel_light keeps of the light in one grid's voxels (src/passes/voxel_light.h).
#ifndef LW_VOXEL_LIGHT_TYPES_H
#define LW_VOXEL_LIGHT_TYPES_H

#include "voxel_format.h"

// Planes of light for each slot of surfaces.
#define LW_LIGHT_FLUX 0  // of three colours
#define LW_LIGHT_DIRECTION \
    3  // three: sum over texels of the colours' flux times the normal; where a volume tells sides apart
#define LW_VOXEL_LIGHT_PLANES 6

// What is kept of a texel: its voxel's number among all slots' voxels and 1 (0: it has none), flux of
// three colours; where directions are told apart its normal, and a word to fill up.
#define LW_LIGHT_RECORD 8
LW_FN lw_int voxel_record(lw_int planes) {
    return planes > LW_LIGHT_DIRECTION ? LW_LIGHT_RECORD : LW_LIGHT_RECORD / 2;
}

// Runs of texels, each sorted by itself, and a run's first. Fewer: some cores have nothing to do; more:
// settling looks for a brick's texels in more places.
#define LW_LIGHT_ROWS 32
LW_FN lw_int voxel_light_row(lw_int row, lw_int texels) {
    const lw_int run = (texels + LW_LIGHT_ROWS - 1) / LW_LIGHT_ROWS;
    return row * run < texels ? row * run : texels;
}
#define LW_LIGHT_LIT_WORDS (LW_VOXEL_BRICK_VOXELS / 32)  // bits of a slot's voxels that hold light

// How words are made of surfaces and light.
typedef struct {
    lw_int mode;      // LWVoxelMode
    lw_int sides;     // 1: six sides on the finest level
    lw_int aware;     // 1: light and opacity of what faces them; 2: light alone
    lw_int feedback;  // 1: of light that arrives at receivers as well
    lw_int size;
    lw_int slots;       // of surfaces
    lw_int planeWords;  // of the finest level's words
    lw_int planes;      // of light: LW_VOXEL_LIGHT_PLANES, or 3 without directions
} LwVoxelContents;
LW_SIZE_CHECK(LwVoxelContents, 32);

// Marks of each slot.
#define LW_LIGHT_TOUCHED 1  // a texel has come to it, left it or changed its light
#define LW_LIGHT_HEARD 4    // what arrives at its receivers has changed

// What befell the frame's texels.
typedef struct {
    lw_int outside;  // texels with flux that lie beyond the grid
    lw_int lost;     // that lie in it, no surface in their voxel or next to it
    lw_int changed;  // 1: some texel is another than in the last frame
    lw_float first, second;  // units of the last frame's sums (LwGridPlace::cell)
    lw_int unused;
} LwVoxelTexels;
LW_SIZE_CHECK(LwVoxelTexels, 24);

// Voxels that hear, for further bounces.
typedef struct {
    lw_int receivers;  // on the list
    lw_int missing;    // that the list has no room for
    lw_int moved;      // 1: the grid lies elsewhere than when they last heard
    lw_int unused;
} LwVoxelReceivers;
LW_SIZE_CHECK(LwVoxelReceivers, 16);

#endif
