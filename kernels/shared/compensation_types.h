// What host and kernels share of the compensation of bounding (docs/techniques/ssvp_compensation.md).
#ifndef LW_COMPENSATION_TYPES_H
#define LW_COMPENSATION_TYPES_H

#include "portable.h"

// Planes of a sender image: position, normal, L_d, the pixel's area / 4 pi, the area of a VPL there / 4 pi.
#define LW_SENDER_POSITION 0
#define LW_SENDER_NORMAL 3
#define LW_SENDER_RADIANCE 6
#define LW_SENDER_PIXEL 9
#define LW_SENDER_VPL 10
#define LW_COMPENSATION_PLANES 11
// Empty columns before and after every run: no sample of a vector at the image's edge reads beyond.
#define LW_SENDER_BORDER 16

// A sample of the surroundings, the same for all pixels of a subset.
typedef struct {
    lw_int x, y;     // way to it in pixels
    lw_float cell;   // pixels that it stands for
    lw_float reserved;
} lw_near_sample;
LW_SIZE_CHECK(lw_near_sample, 16);

// How large the surface behind a pixel is: z^2 K cos(alpha) / cos(beta), z along the axis.
typedef struct {
    lw_float4 eye;   // w: K, a pixel's area at distance 1 (orthographic: at any distance)
    lw_float4 axis;  // unit; w: 1 perspective, 0 orthographic
} lw_pixel_area;
LW_SIZE_CHECK(lw_pixel_area, 32);

// Sender images are dealt by columns: row y holds `interleave` sets of runs, set r the columns r, r + interleave, ... The planes'
// runs of a set follow each other: whole planes one after the other would put all that a sample reads into the same few sets
// of a cache (a third slower).
typedef struct {
    lw_int height, run;   // floats of a run, with its borders
    lw_int interleave;
    lw_int reserved;
} lw_sender_layout;
LW_SIZE_CHECK(lw_sender_layout, 16);

LW_FN lw_int lw_sender_run(lw_sender_layout s, lw_int plane, lw_int y, lw_int residue) {
    return ((y * s.interleave + residue) * LW_COMPENSATION_PLANES + plane) * s.run;
}

#endif
