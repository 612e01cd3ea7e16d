// Second half of the interleaved gather: each pixel takes the mean over a LW_INTERLEAVE^2 window, which
// holds every subset of the VPLs exactly once, of the neighbours on its own surface. At the image's
// border the window is moved inside, so that it stays complete.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 2, 4, 8
#endif
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_weight.h"

#define LW_BACK (LW_INTERLEAVE / 2 - 1)  // the window is [x - LW_BACK, x - LW_BACK + LW_INTERLEAVE)

// Weighted sum of irradiance over the window; `weight` is the sum of the weights.
typedef struct { real r, g, b, weight; } lw_window_sum;

// Where the window's rows begin in each image, and the distances between planes.
typedef struct { int position, normal, irradiance, positionPlane, normalPlane, irradiancePlane; } lw_window_row;

// One row of the window. `inside`, a constant: all lanes have the same shift, so that taps are contiguous;
// otherwise `first` holds each lane's first column.
LW_FN void add_row(lw_window_sum* sum, const lw_surface s, __global const float* position,
                   __global const float* normal, __global const float* irradiance, const lw_window_row row,
                   const int inside, lanei first, int columns) {
#define LW_TAP(image, at) (inside ? load(image, (at) + i) : gather(image, first + (lanei)((at) + i)))
    for (int i = 0; i < columns; ++i) {
        const real w = edge_weight(s, LW_TAP(position, row.position), LW_TAP(position, row.position + row.positionPlane),
                                   LW_TAP(position, row.position + 2 * row.positionPlane), LW_TAP(normal, row.normal),
                                   LW_TAP(normal, row.normal + row.normalPlane),
                                   LW_TAP(normal, row.normal + 2 * row.normalPlane), s.scale);
        sum->r = fma_(w, LW_TAP(irradiance, row.irradiance), sum->r);
        sum->g = fma_(w, LW_TAP(irradiance, row.irradiance + row.irradiancePlane), sum->g);
        sum->b = fma_(w, LW_TAP(irradiance, row.irradiance + 2 * row.irradiancePlane), sum->b);
        sum->weight += w;
    }
#undef LW_TAP
}

// One work-item = LW_WIDTH adjacent pixels of one row. irradiance -> filtered: 3 planes, W/m^2.
__kernel void interleaved_gather_filter(__global const float* position, int4 positionLayout,
                                        __global const float* normal, int4 normalLayout, int width, int height,
                                        __global const float* irradiance, int4 irradianceLayout,
                                        __global float* filtered, int4 filteredLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const int start = x - LW_BACK, firstRow = clamp(y - LW_BACK, 0, max(height - LW_INTERLEAVE, 0));
    const int rows = min(LW_INTERLEAVE, height), columns = min(LW_INTERLEAVE, width);
    const int inside = start >= 0 && start + LW_INTERLEAVE - 1 + LW_WIDTH <= width;
    const lanei first = clamp(lanei_iota() + (lanei)start, (lanei)0, (lanei)max(width - LW_INTERLEAVE, 0));

    lw_window_sum sum = {(real)0.0f, (real)0.0f, (real)0.0f, (real)0.0f};
    if (any_(s.valid)) {
        for (int j = 0; j < rows; ++j) {
            const int shift = inside ? start : 0;
            const lw_window_row row = {positionLayout.x + (firstRow + j) * positionLayout.y + shift,
                                       normalLayout.x + (firstRow + j) * normalLayout.y + shift,
                                       irradianceLayout.x + (firstRow + j) * irradianceLayout.y + shift,
                                       positionLayout.z, normalLayout.z, irradianceLayout.z};
            if (inside) add_row(&sum, s, position, normal, irradiance, row, 1, first, LW_INTERLEAVE);
            else add_row(&sum, s, position, normal, irradiance, row, 0, first, columns);
        }
    }
    // The pixel itself has weight 1 up to rounding, so the sum is never small.
    const real scale = select_((real)0.0f, 1.0f / sum.weight, and_(s.valid, sum.weight > 0.0f));
    const int o = filteredLayout.x + y * filteredLayout.y + x;
    store(sum.r * scale, filtered, o);
    store(sum.g * scale, filtered, o + filteredLayout.z);
    store(sum.b * scale, filtered, o + 2 * filteredLayout.z);
}
