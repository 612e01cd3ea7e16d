// One reflective shadow map among the texels that VPLs are drawn from, as src/inputs/rsm_input.cpp
// derives it from the host's description.
#ifndef LW_RSM_TYPES_H
#define LW_RSM_TYPES_H

#include "input_limits.h"
#include "portable.h"

// Nested cascades of one directional light: each needs the footprints of all finer ones at once.
#define LW_MAX_CASCADES 8

// Smallest cosine between normal and light that a texel's area is divided by: the area grows at most
// 20 times beyond the texel's cross-section. Larger: VPLs on walls lit at grazing angles get too small
// an area, and light close to them is bounded too late (spikes). Smaller: a texel whose normal is nearly
// across the light (a silhouette, an interpolated normal) stands for a huge disc and loses its light.
#define LW_MIN_LIGHT_COSINE 0.05f

// Planes of the texels.
#define LW_RSM_POSITION 0
#define LW_RSM_NORMAL 3
#define LW_RSM_FLUX 6
#define LW_RSM_AREA 9
#define LW_RSM_PLANES 10

// The texels of a map that have no flux for a reason worth counting.
#define LW_RSM_REJECTED 0
#define LW_RSM_COVERED 1
#define LW_RSM_COUNTERS 2  // for each map

typedef struct LwRsmSpan {
    // Perspective: the ray through a texel's centre, of length 1 along the camera's axis; coefficients
    // of (i + 1/2, j + 1/2, -, 1). Orthographic: unused.
    lw_float4 rayX, rayY, rayZ;
    lw_float4 light;  // perspective: the eye (xyz); orthographic: unit vector along the axis (xyz)
    // Finer cascades: clip x, then clip y, of a texel's centre; coefficients of (i + 1/2, j + 1/2, -,
    // 1).
    lw_float4 finer[2 * (LW_MAX_CASCADES - 1)];
    lw_float texelArea;  // orthographic: A_texel across the axis; perspective: at distance 1 along it
    lw_int perspective, finerCount;
    lw_int firstTexel, firstRow, width, height, index;
} LwRsmSpan;
LW_SIZE_CHECK(LwRsmSpan, 16 * (4 + 2 * (LW_MAX_CASCADES - 1)) + 32);

#endif
