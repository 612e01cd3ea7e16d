// How far off a pixel's tangent plane its own surface reaches, measured on the pixels beside it: what an edge test allows no more than.
#ifndef LW_EDGE_SLOPE_H
#define LW_EDGE_SLOPE_H

#include "edge_weight.h"
#include "neighbours.h"

// Of the slope to the pixels right beside, so much is allowed. A surface that curves leaves its tangent plane in proportion to the way, and a
// window of 4 x 4 has its farthest tap 2.8 pixels away (of 8 x 8 it is 5.7, and some of it is left out there). Smaller: the pattern of
// interleaving stays on curved surfaces. Larger: as LW_EDGE_SLOPE_LEAST.
#define LW_EDGE_SLOPE_FACTOR 3.0f
// And at least this, of a plane. Larger: seen at a grazing angle, where a pixel is long, light crosses between parallel layers (a lamp and the
// ceiling above it, a gallery's rail and the floor below). Smaller: positions and normals of compact formats are off their plane by rounding.
#define LW_EDGE_SLOPE_LEAST 0.05f

// Squared sine between a pixel's tangent plane and the way to a point; 1, the largest, where there is no way or no number.
LW_FN real squared_lean(const lw_surface s, real qx, real qy, real qz) {
    const real dx = qx - s.px, dy = qy - s.py, dz = qz - s.pz;
    const real lean2 = sq(fma_(dx, s.nx, fma_(dy, s.ny, dz * s.nz))) / fma_(dx, dx, fma_(dy, dy, dz * dz));
    return select_((real)1.0f, lean2, lean2 < 1.0f);
}

// The squared slope up to which a neighbour counts as on the surface of the pixels x ... of row y. Of the two pixels beside it along a row, and of those
// along a column, the one nearer to the tangent plane counts: an edge lies on one side, and the surface goes on at the other. Where it goes
// on at neither, in what is a pixel wide, and where it is too rough to tell: LW_EDGE_SLOPE.
LW_FN real squared_edge_slope(const lw_surface s, __global const float* position, int4 layout, int x, int y, int width, int height) {
    const int above = layout.x + max(y - 1, 0) * layout.y, here = layout.x + y * layout.y, below = layout.x + min(y + 1, height - 1) * layout.y;
    // Beyond the image's border the pixel itself is taken, to which there is no way.
#define LW_LEAN(row, shift)                                                                                                       \
    squared_lean(s, load_shifted(position, row, x, shift, width), load_shifted(position, row + layout.z, x, shift, width),       \
                 load_shifted(position, row + 2 * layout.z, x, shift, width))
    const real along = fmin(LW_LEAN(here, -1), LW_LEAN(here, 1)), across = fmin(LW_LEAN(above, 0), LW_LEAN(below, 0));
#undef LW_LEAN
    const real slope2 = fma_((real)(LW_EDGE_SLOPE_FACTOR * LW_EDGE_SLOPE_FACTOR), fmax(along, across),
                             (real)(LW_EDGE_SLOPE_LEAST * LW_EDGE_SLOPE_LEAST));
    return fmin(slope2, (real)(LW_EDGE_SLOPE * LW_EDGE_SLOPE));
}

#endif
