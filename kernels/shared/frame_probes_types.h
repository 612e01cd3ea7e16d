// What the probes of a frame look at, for host and kernels (kernels/frame_probes).
#ifndef LW_FRAME_PROBES_TYPES_H
#define LW_FRAME_PROBES_TYPES_H

#include "portable.h"

// Pixels: the middles of a grid over the view, of whatever size, so that halving its resolution looks at the same places.
// More: probes that change less from frame to frame, and cost more. A row is summed up by one work-item.
#define LW_PROBE_COLUMNS 64
#define LW_PROBE_ROWS 36
#define LW_PROBE_PIXELS (LW_PROBE_COLUMNS * LW_PROBE_ROWS)

// Texels: a square grid over each RSM, about so many of all together. A spot of light smaller than a cell of that grid is
// found by the flux of the one texel that stands for the cell, or missed.
#define LW_PROBE_TEXELS 4096
#define LW_PROBE_CHUNKS 64    // that their sums are taken in, one work-item each
#define LW_PROBE_EMITTERS 128 // drawn by flux from the texels; each lights each of the pixels
#define LW_PROBE_PAIRS 1      // of each pixel with an emitter, between which the view is asked for something in front
#define LW_PROBE_STEPS 6      // along each of them; more would find thinner things

// Lengths as shares of the depth (of an orthographic view: of its size).
#define LW_PROBE_PLANE 0.02f  // off a surface's plane: smaller would take curved and noisy surfaces for edges
#define LW_PROBE_DEPTH 0.1f   // in depth, beside the plane: what lies in one plane far behind is not what is shown
#define LW_PROBE_LEAST 0.02f  // in front of a segment: nearer is the surface that it starts or ends on
#define LW_PROBE_MOST 0.3f    // ... and farther is likely to stand before it without touching it

// One RSM among the texels' planes.
typedef struct LwProbeMap {
    lw_int firstTexel, rowLength, width, height;
} LwProbeMap;
LW_SIZE_CHECK(LwProbeMap, 16);

// Planes of the texels looked at.
#define LW_PROBE_WEIGHT 0  // mean of the three fluxes, times the texels that it stands for
#define LW_PROBE_SHOWN 1   // 1: the view shows it
#define LW_PROBE_SURFACE 2 // 1: there is a surface
#define LW_PROBE_X 3
#define LW_PROBE_TEXEL_PLANES 6

// Of a chunk of texels, and of a row of pixels.
typedef struct LwProbeChunk {
    lw_float weight, shown;  // sums
    lw_float squares;        // sum of squared shares of `weight`
    lw_float count;          // of surfaces
    lw_float mean[3], spread; // of their places: mean, and sum of squared distances from it
} LwProbeChunk;
LW_SIZE_CHECK(LwProbeChunk, 32);

// Planes of the pixels looked at, each a sum's term.
#define LW_PROBE_VALID 0
#define LW_PROBE_PX 1
#define LW_PROBE_INDIRECT 4  // luminance of albedo / pi * irradiance, W/(sr m^2)
#define LW_PROBE_DIRECT 5    // of directRadiance
#define LW_PROBE_ALBEDO 6    // luminance
#define LW_PROBE_FACING 7    // emitters
#define LW_PROBE_TESTED 8    // pairs
#define LW_PROBE_HIDDEN 9    // pairs
#define LW_PROBE_NEIGHBOURS 10 // pairs of neighbours of which one at least is a surface
#define LW_PROBE_EDGES 11    // of these, those that do not lie on one surface
#define LW_PROBE_PIXEL_PLANES 12

#define LW_PROBE_HAS_CAMERA 1
#define LW_PROBE_HAS_ALBEDO 2
#define LW_PROBE_HAS_RADIANCE 4

// All of a frame.
typedef struct LwFrameProbes {
    LwProbeChunk pixels;  // weight, shown, squares unused
    LwProbeChunk texels;
    lw_float sums[LW_PROBE_PIXEL_PLANES];
    lw_float emitters;    // that were drawn
    lw_float reserved[3];
} LwFrameProbes;
LW_SIZE_CHECK(LwFrameProbes, 128);

// A number in [0,1) by a counter: where in its cell a texel is looked at, so that no pattern of a texture falls in step with
// the grid. (Wellons' lowbias32.)
LW_FN lw_float lw_probe_jitter(lw_uint n) {
    n ^= n >> 16;
    n *= 0x7feb352du;
    n ^= n >> 15;
    n *= 0x846ca68bu;
    n ^= n >> 16;
    return (lw_float)(n >> 8) * (1.0f / 16777216.0f);
}

#endif
