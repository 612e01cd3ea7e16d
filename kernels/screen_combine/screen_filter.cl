// What one level has gathered, freed of its pattern: each texel takes the mean over the n x n window (n = LW_INTERLEAVE)
// around it, which holds every pattern once, of the texels on its own surface. At the border the window is moved inside.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 2, 4
#endif
#include "shared/wide.h"
#include "screen_combine.h"

#define LW_BACK (LW_INTERLEAVE / 2 - 1)

// One work-item = LW_WIDTH texels of one row. light -> filtered: LW_LIGHT_PLANES planes. texels: the level of the
// pyramid. Lanes whose window is moved inside horizontally are `shift`ed by whole columns, each its own way, so that the
// work-items at the border read column by column what lies in the window of some lane.
__kernel void screen_combine_filter(__global const float* texels, int4 texelLayout, int width, int height,
                                    __global const float* light, int4 lightLayout, __global float* filtered,
                                    int4 filteredLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    lw_lit_texel own;
    load_lit(&own, texels, texelLayout, light, lightLayout, x, y);
    const lw_surface s = make_surface(own.px, own.py, own.pz, own.nx, own.ny, own.nz);
    const lw_edges edges = edges_of(s, (real)1.0f);
    const int firstRow = clamp(y - LW_BACK, 0, max(height - LW_INTERLEAVE, 0)), rows = min(LW_INTERLEAVE, height);
    const lanei column = lanei_iota() + (lanei)x;
    // Where each lane's window begins, less its own column: -LW_BACK but at the border.
    const lanei start = clamp(column - LW_BACK, (lanei)0, (lanei)max(width - LW_INTERLEAVE, 0)) - column;
    const int inside = x - LW_BACK >= 0 && x + LW_WIDTH + LW_INTERLEAVE - 1 - LW_BACK <= width;
    const int from = inside ? -LW_BACK : 1 - LW_INTERLEAVE, to = inside ? LW_INTERLEAVE - LW_BACK : LW_INTERLEAVE;
    lw_light_sum sum;
    clear_sum(&sum);
    if (any_(s.valid))
        for (int j = 0; j < rows; ++j)
            for (int i = from; i < to; ++i) {
                lw_lit_texel t;
                load_lit(&t, texels, texelLayout, light, lightLayout, x + i, firstRow + j);
                real w = lit_weight(&edges, &t);
                if (!inside) w = select_((real)0.0f, w, and_((lanei)i >= start, (lanei)i < start + LW_INTERLEAVE));
                add_lit(&sum, w, &t);
            }
    const real scale = select_((real)0.0f, 1.0f / sum.weight, and_(s.valid, sum.weight > 0.0f));
    const int o = filteredLayout.x + y * filteredLayout.y + x;
    for (int a = 0; a < LW_LIGHT_PLANES; ++a) store(sum.v[a] * scale, filtered, o + a * filteredLayout.z);
}
