// What host and kernels share of screen-space indirect light (kernels/screen_gather, kernels/screen_combine).
#ifndef LW_SCREEN_TYPES_H
#define LW_SCREEN_TYPES_H

#include "input_limits.h"
#include "portable.h"
#include "pyramid_types.h"

// Planes of a level's light: irradiance in W/m^2, and the share of the cosine-weighted hemisphere that its samples fill.
#define LW_LIGHT_SHARE 3
#define LW_LIGHT_PLANES 4

// Planes of a pyramid's level that senders need: position, normal, radiance, area.
#define LW_SENDER_RADIANCE 6
#define LW_SENDER_AREA 9
#define LW_SENDER_PLANES 10

// One sample of a pattern: the texel `column`, `row` away from the receiver's. Rows of a level are dealt by columns
// modulo the interleave, so that its column is `phase`, `step`: the segment, and the offset within it. `weight`: how
// many texels it stands for.
typedef struct LwScreenSample {
    lw_int phase, step, row;
    lw_float weight;
} LwScreenSample;
LW_SIZE_CHECK(LwScreenSample, 16);

// Where a point lies among the texels of another camera's level: with v from its eye and u = (v, 1), column rowX.u / rowW.u,
// row rowY.u / rowW.u, texel centres at + 1/2.
typedef struct LwScreenCamera {
    lw_float4 eye;  // xyz; w: area of a texel across the axis, at distance 1 of a perspective camera
    lw_float4 axis;  // xyz; w: 1 perspective, 0 orthographic
    lw_float4 rowX, rowY, rowW;
} LwScreenCamera;
LW_SIZE_CHECK(LwScreenCamera, 80);

// Counters of a view.
#define LW_SCREEN_REJECTED_PIXELS 0
#define LW_SCREEN_REJECTED_RADIANCE 1
#define LW_SCREEN_FALLBACKS 2
#define LW_SCREEN_SATURATED 3
#define LW_SCREEN_COUNTERS 4

// Most that one sample may be to a receiver, as a share of its hemisphere times pi. Bounded samples stay below 4;
// without the bound a sample that touches its receiver would be infinite, and 0 radiance times it no number.
#define LW_LARGEST_SAMPLE 1e6f

#endif
