// Cones through voxels (voxel_types.h, voxel_format.h): what kernels and host share. How far a cone has come at each of its samples
// is the same for all pixels, so that no lane takes a logarithm, and nothing switches from one pixel to the next.
#ifndef LW_CONE_TYPES_H
#define LW_CONE_TYPES_H

#include "portable.h"

// What still gets through is taken for nothing below this: 0.1 % of what a cone meets.
#define LW_CONE_LEAST 1e-3f

// Apertures of glossy cones are one of so many, each as wide as the one before by the same factor, so that the lanes of a class have one
// schedule. Fewer: blur changes in steps of more than a tenth; more: more classes in a picture of all roughnesses, each a trace.
#define LW_CONE_APERTURES 48

typedef struct {
    // xyz: of a set about a normal, in the frame of two tangents and the normal; of a set over the sphere, in the world. w: share
    // of the set, all together 1.
    lw_float4 direction;
    lw_int first, count;  // of its steps
    lw_int unused[2];
} LwCone;
LW_SIZE_CHECK(LwCone, 32);

// One sample of a cone. Distances in voxels of the grid that the cone begins in.
typedef struct {
    lw_float distance;  // from the point
    lw_float exponent;  // of transmittance: cells that the step is long, where they grow as the cone does
    lw_float light;     // share of the radiance that counts
    lw_float dimming;   // what of the opacity ambient occlusion counts
    lw_int level;       // cells of 2^level voxels
    lw_float begins;    // how far the grid has to reach for it to count: half a cell less than the distance
    lw_int unused[2];
} LwConeStep;
LW_SIZE_CHECK(LwConeStep, 32);

// How a volume's words lie (src/passes/voxel_volume.h).
typedef struct {
    lw_int size, levels, cascades;
    lw_int table;                // ints of the table from one cascade to the next
    lw_int basePlane, mipPlane;  // words from one plane to the next
    lw_int first[10];            // brick of each level in a cascade's table
} LwConeGrids;
LW_SIZE_CHECK(LwConeGrids, 64);

// What a trace takes beside it.
typedef struct {
    lw_float4 environment;  // rgb, W/(sr m^2); w: how far cones reach, in voxels of the finest grid
    lw_float4 eye;          // as LwSpecularRays'
    lw_float4 light;        // of shadows: place of a point or spot light (w = 1), or the way towards a directional one (w = 0)
    lw_float4 rough;        // x: roughness where there is no image of it; y: refractive index; z: nudge in voxels
} LwConeView;
LW_SIZE_CHECK(LwConeView, 64);

#endif
