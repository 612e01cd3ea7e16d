// What the point occlusion takes from the host (kernels/point_occlusion).
#ifndef LW_POINT_OCCLUSION_TYPES_H
#define LW_POINT_OCCLUSION_TYPES_H

#include "portable.h"

typedef struct {
    lw_float4 eye;      // xyz; w: 1 perspective, 0 orthographic
    // Rows that lead from p - eye to column, row (in texels of the gathered image, from its corner) and depth along the
    // axis; perspective: column and row times that depth. w: added.
    lw_float4 column, row, depth;
    lw_float4 range;    // x: radius at depth 1 (orthographic: anywhere); y: depths count as different from this share of
                        // the radius on; z: 1 with the range check; w: points
} lw_point_view;
LW_SIZE_CHECK(lw_point_view, 80);

#endif
