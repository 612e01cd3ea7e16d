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

typedef struct { int inside; int start; lanei lanes; } lw_window;

// Column of the window's first tap, per lane; `inside`: the same shift for all lanes.
LW_FN lw_window window_at(int x, int width) {
    lw_window w;
    w.inside = x - LW_BACK >= 0 && x - LW_BACK + LW_INTERLEAVE - 1 + LW_WIDTH <= width;
    w.start = x - LW_BACK;
    w.lanes = clamp(lanei_iota() + (lanei)(x - LW_BACK), (lanei)0, (lanei)max(width - LW_INTERLEAVE, 0));
    return w;
}

LW_FN real tap(__global const float* image, int row, const lw_window w, int i) {
    return w.inside ? load(image, row + w.start + i) : gather(image, (lanei)(row + i) + w.lanes);
}

// One work-item = LW_WIDTH adjacent pixels of one row. irradiance -> filtered: 3 planes, W/m^2.
__kernel void interleaved_gather_filter(__global const float* position, int4 positionLayout,
                                        __global const float* normal, int4 normalLayout, int width, int height,
                                        __global const float* irradiance, int4 irradianceLayout,
                                        __global float* filtered, int4 filteredLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
    const int pz = positionLayout.z, nz = normalLayout.z, ez = irradianceLayout.z;
    const lw_surface s = make_surface(load(position, p), load(position, p + pz), load(position, p + 2 * pz),
                                      load(normal, n), load(normal, n + nz), load(normal, n + 2 * nz));
    const lw_window window = window_at(x, width);
    const int firstRow = clamp(y - LW_BACK, 0, max(height - LW_INTERLEAVE, 0));
    const int rows = min(LW_INTERLEAVE, height), columns = min(LW_INTERLEAVE, width);

    real r = (real)0.0f, g = (real)0.0f, b = (real)0.0f, sum = (real)0.0f;
    if (any_(s.valid)) {
        for (int j = 0; j < rows; ++j) {
            const int q = positionLayout.x + (firstRow + j) * positionLayout.y;
            const int m = normalLayout.x + (firstRow + j) * normalLayout.y;
            const int e = irradianceLayout.x + (firstRow + j) * irradianceLayout.y;
            for (int i = 0; i < columns; ++i) {
                const real w = edge_weight(s, tap(position, q, window, i), tap(position, q + pz, window, i),
                                           tap(position, q + 2 * pz, window, i), tap(normal, m, window, i),
                                           tap(normal, m + nz, window, i), tap(normal, m + 2 * nz, window, i));
                r = fma_(w, tap(irradiance, e, window, i), r);
                g = fma_(w, tap(irradiance, e + ez, window, i), g);
                b = fma_(w, tap(irradiance, e + 2 * ez, window, i), b);
                sum += w;
            }
        }
    }
    // The pixel itself has weight 1 up to rounding of its normal's length, so `sum` is never small.
    const real scale = select_((real)0.0f, 1.0f / sum, and_(s.valid, sum > 0.0f));
    const int o = filteredLayout.x + y * filteredLayout.y + x;
    store(r * scale, filtered, o);
    store(g * scale, filtered, o + filteredLayout.z);
    store(b * scale, filtered, o + 2 * filteredLayout.z);
}
