// Edge-aware box filter of weighted sums: what neighbouring pixels of one surface gathered with different patterns is
// added up over a window and divided by the sum of the weights. Where patterns repeat every n pixels, n even, the window
// is n + 1 pixels with its two ends at half weight: each pattern counts once, and the mean lies on the pixel. (A window of n
// lies half a pixel off, which at 120 rows took 8 % of the light in a contact's region away.) LW_LIGHT 1: planes
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

// Adds row j of the window, of which the row at `p`, `n`, `g` holds the pixels. `inside`, a constant: all columns exist.
LW_FN void add_row(real* sum, const lw_edges edges, mask valid, __global const float* position, int p, int positionPlane,
                   __global const float* normal, int n, int normalPlane, __global const float* gathered, int g,
                   int gatheredPlane, int x, int width, int columns, float rowWeight, int ownRow, const int inside) {
#define LW_TAP(image, at) (inside ? load(image, (at) + x + i) : load_shifted(image, (at), x, i, width))
    const int far = columns / 2;
    for (int i = -far; i <= far; ++i) {
        real w = edge_weight(edges, LW_TAP(position, p), LW_TAP(position, p + positionPlane), LW_TAP(position, p + 2 * positionPlane),
                             LW_TAP(normal, n), LW_TAP(normal, n + normalPlane), LW_TAP(normal, n + 2 * normalPlane));
        // The pixel itself counts in full, whatever rounding makes of its own tests.
        if (ownRow && i == 0) w = ones_(valid);
        if (!inside) {
            const lanei column = lanei_iota() + (lanei)(x + i);
            w = select_((real)0.0f, w, and_(column >= (lanei)0, column < (lanei)width));
        }
        w *= far > 0 && abs(i) == far ? 0.5f * rowWeight : rowWeight;
        for (int a = 0; a < LW_PLANES; ++a) sum[a] = fma_(w, LW_TAP(gathered, g + a * gatheredPlane), sum[a]);
    }
#undef LW_TAP
}

// One work-item = LW_WIDTH adjacent pixels. position, normal: 3 planes each (normal: unit or zero). irradiance (3 planes,
// W/m^2), validity and open (1 plane each): where the means go, or null. columns, rows: 1 or even, after which patterns
// repeat.
__kernel void weighted_filter_filter(__global const float* position, int4 positionLayout, __global const float* normal,
                                     int4 normalLayout, int width, int height, int columns, int rows,
                                     __global const float* gathered, int4 gatheredLayout, __global float* irradiance,
                                     int4 irradianceLayout, __global float* validity, int4 validityLayout,
                                     __global float* open, int4 openLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    s.valid = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    const lw_edges edges = edges_of(s, s.scale);
    // At the image's upper and lower border a window of `rows` rows, shifted inwards: every pattern once.
    const int far = rows / 2, centred = y >= far && y + far < height;
    const int firstRow = centred ? y - far : clamp(y - far, 0, max(height - rows, 0));
    const int lastRow = centred ? y + far : min(firstRow + rows, height) - 1;
    const int inside = shift_inside(x, -(columns / 2), width) && shift_inside(x, columns / 2, width);
    real sum[LW_PLANES];
    for (int a = 0; a < LW_PLANES; ++a) sum[a] = (real)0.0f;
    for (int j = firstRow; j <= lastRow; ++j) {
        const float rowWeight = centred && far > 0 && abs(j - y) == far ? 0.5f : 1.0f;
        const int p = positionLayout.x + j * positionLayout.y, n = normalLayout.x + j * normalLayout.y;
        const int g = gatheredLayout.x + j * gatheredLayout.y;
        if (inside)
            add_row(sum, edges, s.valid, position, p, positionLayout.z, normal, n, normalLayout.z, gathered, g, gatheredLayout.z, x,
                    width, columns, rowWeight, j == y, 1);
        else
            add_row(sum, edges, s.valid, position, p, positionLayout.z, normal, n, normalLayout.z, gathered, g, gatheredLayout.z, x,
                    width, columns, rowWeight, j == y, 0);
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
