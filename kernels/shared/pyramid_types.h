// A G-buffer's mip pyramid, as kernels and host agree on it (kernels/mip_pyramid).
#ifndef LW_PYRAMID_TYPES_H
#define LW_PYRAMID_TYPES_H

#include "portable.h"

// Columns without a surface left of each row, and right of its length rounded up to 16: a vector of texels may
// start anywhere from column -16 on and be read whole. A texel there has a zero normal, area and radiance.
#define LW_PYRAMID_BORDER 16

// Planes of a level, in this order; those beyond the normal only where asked for.
#define LW_PYRAMID_POSITION 0
#define LW_PYRAMID_NORMAL 3

// Smallest cosine between a surface's normal and the way to the eye that a pixel's area is divided by: the area
// grows at most 50 times beyond the pixel's cross-section. Larger: floors seen at grazing angles send too little
// light. Smaller: a pixel whose interpolated normal faces away from the camera stands for a huge surface.
#define LW_MIN_VIEW_COSINE 0.02f

// Radiance above which a pixel sends nothing and counts as rejected: sums over pixels stay finite.
#define LW_LARGEST_RADIANCE 1e30f

typedef struct LwPyramidCamera {
    lw_float4 eye;   // xyz; w: area of a base pixel across the axis, at distance 1 of a perspective camera
    lw_float4 axis;  // xyz: unit, along which depth grows; w: 1 perspective, 0 orthographic
} LwPyramidCamera;
LW_SIZE_CHECK(LwPyramidCamera, 32);

#endif
