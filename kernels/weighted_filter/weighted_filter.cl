// Edge-aware box filter of weighted sums: what neighbouring pixels of one surface gathered with different patterns is
// added up over a window, first down each column, then along the row, and divided by the sum of the weights. (In one step a
// window of 9 x 9 pixels costs 81 taps in place of 18.) Each step measures surfaces against the pixel in its middle. Where patterns repeat every n pixels, n even, the window
// is n + 1 pixels with its two ends at half weight: each pattern counts once, and the mean lies on the pixel. (A window of n
// lies half a pixel off, which at 120 rows and n = 4 took 8 % of the light in a contact's region away.) LW_LIGHT 1: planes
// radiance rgb, seen share, open share, weight; 0: open share, weight.
#ifndef LW_LIGHT
#define LW_LIGHT 1
#endif
#include "shared/edge_weight.h"
#include "shared/neighbours.h"

#if LW_LIGHT
#define LW_PLANES 6
#else
#define LW_PLANES 2
#endif

// Adds the pixels `shift` columns from the work-item's on the row at `p`, `n`, `g` to the sums. `own`: those are the pixels
// themselves, which count in full, whatever rounding makes of their own tests. `inside`: all columns exist.
LW_FN void add_tap(real* sum, const lw_edges edges, mask valid, __global const float* position, int p, int positionPlane,
                   __global const float* normal, int n, int normalPlane, __global const float* gathered, int g,
                   int gatheredPlane, int x, int shift, int width, float factor, int own, const int inside) {
#define LW_TAP(image, at) (inside ? load(image, (at) + x + shift) : load_shifted(image, (at), x, shift, width))
    real w = edge_weight(edges, LW_TAP(position, p), LW_TAP(position, p + positionPlane), LW_TAP(position, p + 2 * positionPlane),
                         LW_TAP(normal, n), LW_TAP(normal, n + normalPlane), LW_TAP(normal, n + 2 * normalPlane));
    if (own) w = ones_(valid);
    if (!inside) {
        const lanei column = lanei_iota() + (lanei)(x + shift);
        w = select_((real)0.0f, w, and_(column >= (lanei)0, column < (lanei)width));
    }
    w *= factor;
    for (int a = 0; a < LW_PLANES; ++a) sum[a] = fma_(w, LW_TAP(gathered, g + a * gatheredPlane), sum[a]);
#undef LW_TAP
}

// One work-item = LW_WIDTH adjacent pixels: the sums over the window's rows, at their own columns. position, normal: 3
// planes each (normal: unit or zero). rows: 1 or even, after which patterns repeat. sums: as gathered.
__kernel void weighted_filter_columns(__global const float* position, int4 positionLayout, __global const float* normal,
                                      int4 normalLayout, int width, int height, int rows, __global const float* gathered,
                                      int4 gatheredLayout, __global float* sums, int4 sumsLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    s.valid = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    const lw_edges edges = edges_of(s, s.scale);
    // At the image's upper and lower border a window of `rows` rows, shifted inwards: every pattern once.
    const int far = rows / 2, centred = y >= far && y + far < height;
    const int firstRow = centred ? y - far : clamp(y - far, 0, max(height - rows, 0));
    const int lastRow = centred ? y + far : min(firstRow + rows, height) - 1;
    real sum[LW_PLANES];
    for (int a = 0; a < LW_PLANES; ++a) sum[a] = (real)0.0f;
    for (int j = firstRow; j <= lastRow; ++j)
        add_tap(sum, edges, s.valid, position, positionLayout.x + j * positionLayout.y, positionLayout.z, normal,
                normalLayout.x + j * normalLayout.y, normalLayout.z, gathered, gatheredLayout.x + j * gatheredLayout.y,
                gatheredLayout.z, x, 0, width, centred && far > 0 && abs(j - y) == far ? 0.5f : 1.0f, j == y, 1);
    for (int a = 0; a < LW_PLANES; ++a)
        store(select_((real)0.0f, sum[a], s.valid), sums, sumsLayout.x + a * sumsLayout.z + y * sumsLayout.y + x);
}

// One work-item = LW_WIDTH adjacent pixels: the means over the window's columns. position, normal: as above. irradiance
// (3 planes, W/m^2), validity and open (1 plane each): where they go, or null. columns: 1 or even, after which patterns repeat.
__kernel void weighted_filter_filter(__global const float* position, int4 positionLayout, __global const float* normal,
                                     int4 normalLayout, int width, int height, int columns, __global const float* gathered,
                                     int4 gatheredLayout, __global float* irradiance, int4 irradianceLayout,
                                     __global float* validity, int4 validityLayout, __global float* open, int4 openLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    s.valid = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    const lw_edges edges = edges_of(s, s.scale);
    const int far = columns / 2, inside = shift_inside(x, -far, width) && shift_inside(x, far, width);
    const int p = positionLayout.x + y * positionLayout.y, n = normalLayout.x + y * normalLayout.y;
    const int g = gatheredLayout.x + y * gatheredLayout.y;
    real sum[LW_PLANES];
    for (int a = 0; a < LW_PLANES; ++a) sum[a] = (real)0.0f;
    for (int i = -far; i <= far; ++i) {
        const float factor = far > 0 && abs(i) == far ? 0.5f : 1.0f;
        if (inside)
            add_tap(sum, edges, s.valid, position, p, positionLayout.z, normal, n, normalLayout.z, gathered, g, gatheredLayout.z,
                    x, i, width, factor, i == 0, 1);
        else
            add_tap(sum, edges, s.valid, position, p, positionLayout.z, normal, n, normalLayout.z, gathered, g, gatheredLayout.z,
                    x, i, width, factor, i == 0, 0);
    }
    const mask lit = and_(s.valid, sum[LW_PLANES - 1] > 0.0f);
    const real scale = select_((real)0.0f, 1.0f / sum[LW_PLANES - 1], lit), zero = (real)0.0f;
#if LW_LIGHT
    if (irradiance) {
        const int o = irradianceLayout.x + y * irradianceLayout.y + x;
        for (int a = 0; a < 3; ++a) store(select_(zero, M_PI_F * scale * sum[a], lit), irradiance, o + a * irradianceLayout.z);
    }
    // Means of shares: rounding must not lift them above 1.
    if (validity)
        store(select_(zero, fmin(scale * sum[3], (real)1.0f), lit), validity, validityLayout.x + y * validityLayout.y + x);
#endif
    if (open)
        store(select_(zero, fmin(scale * sum[LW_PLANES - 2], (real)1.0f), lit), open, openLayout.x + y * openLayout.y + x);
}
