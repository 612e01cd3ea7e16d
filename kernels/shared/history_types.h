// Where a point was seen in the frame before, as the host derives it from the camera of that frame
// (src/passes/temporal_history.cpp) and the kernel applies it to every pixel.
#ifndef LW_HISTORY_TYPES_H
#define LW_HISTORY_TYPES_H

#include "portable.h"

#define LW_HISTORY_NONE 0       // nothing to read: the first frame, a cut
#define LW_HISTORY_STILL 1      // every surface stands where it stood in the picture
#define LW_HISTORY_REPROJECT 2  // by the camera of the frame before
#define LW_HISTORY_MOTION 3     // by motion vectors

// All rows are linear in X - origin (xyz) plus a constant (w); pixels are those of the history's picture.
typedef struct LwReprojection {
    lw_float4 x, y, w;           // image coordinates are x / w and y / w, pixel centres at + 1/2; w > 0 before the camera
    lw_float4 depth;             // along the axis; 1 for an orthographic camera
    lw_float4 acrossX, acrossY;  // world vectors of a pixel to the right and down, at depth 1
    lw_float4 origin;            // at or near the eye; w: a pixel's width at depth 1
    lw_float4 shiftHigh, shiftLow;  // from this frame's positions to the history's, in two parts
    lw_float scaleX, scaleY;     // the history's pixels to one of this frame's
    lw_int width, height;        // of the history
} LwReprojection;
LW_SIZE_CHECK(LwReprojection, 160);

#endif
