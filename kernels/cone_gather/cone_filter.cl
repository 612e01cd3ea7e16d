// Second half of the interleaved cones: each pixel takes the sums over a window of LW_CONE_COLUMNS x LW_CONE_ROWS pixels, which holds each cone
// exactly once, of the neighbours on its own surface, over the sum of their cones' weights: what an edge leaves out changes which
// directions count, not how much light there is. At the image's border the window is moved inside, so that it stays complete.
#ifndef LW_CONE_COLUMNS
#define LW_CONE_COLUMNS 3
#endif
#ifndef LW_CONE_ROWS
#define LW_CONE_ROWS 3
#endif
#include "shared/edge_weight.h"
#include "shared/neighbours.h"
#include "shared/wide.h"

#define LW_GATHERED 6
// Pixels of the window to the left of and above its middle.
#define LW_LEFT ((LW_CONE_COLUMNS - 1) / 2)
#define LW_ABOVE ((LW_CONE_ROWS - 1) / 2)

// One work-item = LW_WIDTH adjacent pixels. gathered: as cone_gather_trace leaves them. irradiance: 3 planes, W/m^2; validity, open.
__kernel void cone_gather_filter(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                                 int width, int height, __global const float* gathered, int4 gatheredLayout, int hasIrradiance,
                                 int hasValidity, int hasOpen, __global float* irradiance, int4 irradianceLayout,
                                 __global float* validity, int4 validityLayout, __global float* open, int4 openLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    s.valid = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    const lw_edges edges = edges_of(s, s.scale);
    const int start = x - LW_LEFT, columns = min(LW_CONE_COLUMNS, width), rows = min(LW_CONE_ROWS, height);
    const int inside = start >= 0 && start + LW_CONE_COLUMNS - 1 + LW_WIDTH <= width;
    const lanei first = clamp(lanei_iota() + (lanei)start, (lanei)0, (lanei)max(width - LW_CONE_COLUMNS, 0));
    const int firstRow = clamp(y - LW_ABOVE, 0, max(height - LW_CONE_ROWS, 0));
    const real none = (real)0.0f;
    real sum[LW_GATHERED];
    for (int a = 0; a < LW_GATHERED; ++a) sum[a] = none;
    if (any_(s.valid)) {
        for (int j = firstRow; j < firstRow + rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const int p = positionLayout.x + j * positionLayout.y + i, n = normalLayout.x + j * normalLayout.y + i;
                const int g = gatheredLayout.x + j * gatheredLayout.y + i;
#define LW_TAP(image, at) (inside ? load(image, (at) + start) : gather(image, first + (lanei)(at)))
                const real w = edge_weight(edges, LW_TAP(position, p), LW_TAP(position, p + positionLayout.z),
                                           LW_TAP(position, p + 2 * positionLayout.z), LW_TAP(normal, n), LW_TAP(normal, n + normalLayout.z),
                                           LW_TAP(normal, n + 2 * normalLayout.z));
                for (int a = 0; a < LW_GATHERED; ++a) sum[a] = fma_(w, LW_TAP(gathered, g + a * gatheredLayout.z), sum[a]);
#undef LW_TAP
            }
    }
    const mask lit = and_(s.valid, sum[5] > none);
    const real scale = select_(none, 1.0f / sum[5], lit), one = (real)1.0f;
    if (hasIrradiance)
        for (int a = 0; a < 3; ++a)
            store(select_(none, M_PI_F * scale * sum[a], lit), irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y + x);
    if (hasOpen) store(select_(none, fmin(scale * sum[3], one), lit), open, openLayout.x + y * openLayout.y + x);
    if (hasValidity) store(select_(none, fmin(scale * sum[4], one), lit), validity, validityLayout.x + y * validityLayout.y + x);
}
