// Second half of the interleaved gather: each pixel takes the mean over a LW_INTERLEAVE^2 window, which
// holds every subset of the VPLs exactly once, of the neighbours on its own surface. At the image's
// border the window is moved inside, so that it stays complete.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 2, 4, 8
#endif
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_slope.h"
#include "shared/edge_weight.h"
#include "shared/filter_rows.h"
#include "shared/doubtful_light.h"
#ifndef LW_DOUBT
#define LW_DOUBT 0  // 1: a fourth plane of the irradiance holds what of its sum over the channels is doubtful
#endif

#define LW_UNROLL _Pragma("unroll")
#define LW_BACK (LW_INTERLEAVE / 2 - 1)  // the window is [x - LW_BACK, x - LW_BACK + LW_INTERLEAVE)

// Weighted sum of irradiance over the window; `weight` is the sum of the weights.
typedef struct { real r, g, b, weight, doubt; } lw_window_sum;

// Where the window's rows begin in each image, and the distances between planes.
typedef struct { int position, normal, irradiance, positionPlane, normalPlane, irradiancePlane; } lw_window_row;

// One row of images, for those of a work-item's rows whose windows hold it (`which`, a bit each): what is loaded serves
// all of them. `inside`, a constant: all lanes have the same shift, so that taps are contiguous; otherwise `first`
// holds each lane's first column.
LW_FN void add_row(lw_window_sum* sums, const lw_edges* edges, const int which, __global const float* position,
                   __global const float* normal, __global const float* irradiance, const lw_window_row row,
                   const int inside, lanei first, int columns) {
#define LW_TAP(image, at) (inside ? load(image, (at) + i) : gather(image, first + (lanei)((at) + i)))
    for (int i = 0; i < columns; ++i) {
        const real px = LW_TAP(position, row.position), py = LW_TAP(position, row.position + row.positionPlane),
                   pz = LW_TAP(position, row.position + 2 * row.positionPlane);
        const real nx = LW_TAP(normal, row.normal), ny = LW_TAP(normal, row.normal + row.normalPlane),
                   nz = LW_TAP(normal, row.normal + 2 * row.normalPlane);
        const real r = LW_TAP(irradiance, row.irradiance), g = LW_TAP(irradiance, row.irradiance + row.irradiancePlane),
                   b = LW_TAP(irradiance, row.irradiance + 2 * row.irradiancePlane);
        const real doubt = LW_DOUBT ? LW_TAP(irradiance, row.irradiance + 3 * row.irradiancePlane) : (real)0.0f;
        LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k) {
            if (!(which >> k & 1)) continue;
            const real w = edge_weight(edges[k], px, py, pz, nx, ny, nz);
            sums[k].r = fma_(w, r, sums[k].r);
            sums[k].g = fma_(w, g, sums[k].g);
            sums[k].b = fma_(w, b, sums[k].b);
            sums[k].weight += w;
            if (LW_DOUBT) sums[k].doubt = fma_(w, doubt, sums[k].doubt);
        }
    }
#undef LW_TAP
}

// The mean over the window of pixels (x, y), and whether they are surfaces.
LW_FN void store_mean(const lw_window_sum sum, mask valid, __global float* filtered, int4 filteredLayout,
                      __global float* validity, int4 validityLayout, int hasValidity, int x, int y) {
    // The pixel itself has weight 1 up to rounding, so the sum is never small.
    real scale = select_((real)0.0f, 1.0f / sum.weight, and_(valid, sum.weight > 0.0f));
    if (LW_DOUBT) scale *= borne_out(sum.r + sum.g + sum.b, sum.doubt);
    const int o = filteredLayout.x + y * filteredLayout.y + x;
    store_past(sum.r * scale, filtered, o);
    store_past(sum.g * scale, filtered, o + filteredLayout.z);
    store_past(sum.b * scale, filtered, o + 2 * filteredLayout.z);
    if (hasValidity) store_past(ones_(valid), validity, validityLayout.x + y * validityLayout.y + x);
}

// One work-item = LW_WIDTH adjacent pixels of LW_FILTER_ROWS rows. irradiance -> filtered: 3 planes, W/m^2 (with LW_DOUBT: 4 -> 3). validity: 1 on
// surfaces, 0 elsewhere; not written unless hasValidity.
__kernel void interleaved_gather_filter(__global const float* position, int4 positionLayout,
                                        __global const float* normal, int4 normalLayout, int width, int height,
                                        __global const float* irradiance, int4 irradianceLayout,
                                        __global float* filtered, int4 filteredLayout, __global float* validity,
                                        int4 validityLayout, int hasValidity) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1) * LW_FILTER_ROWS;
    if (x >= width || y >= height) return;
    const int start = x - LW_BACK, lastRow = max(height - LW_INTERLEAVE, 0);
    const int rows = min(LW_INTERLEAVE, height), columns = min(LW_INTERLEAVE, width);
    const int inside = start >= 0 && start + LW_INTERLEAVE - 1 + LW_WIDTH <= width;
    const lanei first = clamp(lanei_iota() + (lanei)start, (lanei)0, (lanei)max(width - LW_INTERLEAVE, 0));

    lw_edges edges[LW_FILTER_ROWS];
    mask valid[LW_FILTER_ROWS];
    lw_window_sum sums[LW_FILTER_ROWS];
    mask some = splat_mask(0);
    LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k) {
        const lw_window_sum none = {(real)0.0f, (real)0.0f, (real)0.0f, (real)0.0f, (real)0.0f};
        const lw_surface s =
            load_surface(position, positionLayout, normal, normalLayout, x, min(y + k, height - 1));
        edges[k] = edges_within(s, s.scale, squared_edge_slope(s, position, positionLayout, x, min(y + k, height - 1), width, height));
        valid[k] = s.valid;
        sums[k] = none;
        some = or_(some, s.valid);
    }
    const int from = clamp(y - LW_BACK, 0, lastRow), second = clamp(y + LW_FILTER_ROWS - 1 - LW_BACK, 0, lastRow);
    // The window's last rows, which no work-item before has read, for the next one beside this.
    LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k) {
        const int row = max(second + rows - 1 - k, 0);
        LW_UNROLL for (int a = 0; a < 3; ++a) {
            will_load(position + positionLayout.x + a * positionLayout.z + row * positionLayout.y + x + LW_WIDTH);
            will_load(normal + normalLayout.x + a * normalLayout.z + row * normalLayout.y + x + LW_WIDTH);
            will_load(irradiance + irradianceLayout.x + a * irradianceLayout.z + row * irradianceLayout.y + x + LW_WIDTH);
        }
    }
    if (any_(some)) {
        for (int j = from; j < second + rows; ++j) {
            const int shift = inside ? start : 0;
            const lw_window_row row = {positionLayout.x + j * positionLayout.y + shift,
                                       normalLayout.x + j * normalLayout.y + shift,
                                       irradianceLayout.x + j * irradianceLayout.y + shift,
                                       positionLayout.z, normalLayout.z, irradianceLayout.z};
            const int which = (j < from + rows ? 1 : 0) | (j >= second ? 2 : 0);
            if (!inside) add_row(sums, edges, which, position, normal, irradiance, row, 0, first, columns);
            else if (which == 3) add_row(sums, edges, 3, position, normal, irradiance, row, 1, first, LW_INTERLEAVE);
            else if (which == 1) add_row(sums, edges, 1, position, normal, irradiance, row, 1, first, LW_INTERLEAVE);
            else add_row(sums, edges, 2, position, normal, irradiance, row, 1, first, LW_INTERLEAVE);
        }
    }
    LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k)
        if (y + k < height)
            store_mean(sums[k], valid[k], filtered, filteredLayout, validity, validityLayout, hasValidity, x, y + k);
}
