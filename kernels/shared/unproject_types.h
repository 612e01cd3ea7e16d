// From a depth image back to world positions: what the host derives in double precision from a camera's
// matrices (src/inputs/camera.cpp holds the derivation) and the kernel applies to every pixel.
#ifndef LW_UNPROJECT_TYPES_H
#define LW_UNPROJECT_TYPES_H

#include "portable.h"

#define LW_UNPROJECT_HOMOGENEOUS 0  // origin + xyz / w, each linear in (i + 1/2, j + 1/2, depth, 1)
#define LW_UNPROJECT_AXIAL 1        // origin + depth * ray, the ray linear in (i + 1/2, j + 1/2, 1)
#define LW_UNPROJECT_RADIAL 2       // origin + depth * ray / |ray|

// Positions are computed relative to `origin` (at or near the eye) and moved last: far from the world's
// origin only the final sum is rounded at the size of world coordinates.
typedef struct LwUnprojection {
    lw_float4 x, y, z, w;  // coefficients of (i + 1/2, j + 1/2, depth, 1)
    lw_float4 wRest;       // what rounding w to float lost: w cancels at large depths
    lw_float4 origin;
    lw_int mode;
    lw_int positiveOnly;  // 1: the depth is a distance, and 0 or less is no surface
    lw_int reserved0, reserved1;
} LwUnprojection;
LW_SIZE_CHECK(LwUnprojection, 112);

#endif
