// What one level has gathered, freed of its pattern: each texel takes the mean over the texels on its own surface up to n / 2
// away (n = LW_INTERLEAVE), of which those at either end count half. Along a row and along a column each of the n patterns
// then has the same weight, and the window stands about the texel: one of n texels would lie half a texel off it, and the
// light of each level with it, by more pixels the coarser the level.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 2, 4
#endif
#ifndef LW_PLANNED
#define LW_PLANNED 0  // 1: the plan of the frame says which levels are gathered, and with how many samples
#endif
#include "shared/screen_plan_types.h"
#include "shared/wide.h"
#include "screen_combine.h"

#define LW_REACH (LW_INTERLEAVE / 2)

LW_FN float window_weight(int i) { return i == -LW_REACH || i == LW_REACH ? 0.5f : 1.0f; }

// One work-item = LW_WIDTH texels of one row. light -> filtered: LW_LIGHT_PLANES planes. texels: the level of the
// pyramid, whose rows have columns without a surface either side. alike: all patterns are, and nothing is to be filtered; with a
// plan, the sum of those numbers of samples of which they are, and discsAlike that for the level that the picture starts with. plan: by
// level, how many samples it has; a level without any has no light.
__kernel void screen_combine_filter(__global const float* texels, int4 texelLayout, int width, int height, int alike,
                                    __global const float* light, int4 lightLayout, __global float* filtered,
                                    int4 filteredLayout
#if LW_PLANNED
                                    , int discsAlike, __global const int* plan, int level
#endif
) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int o = filteredLayout.x + y * filteredLayout.y + x;
#if LW_PLANNED
    const int samples = plan[LW_SCREEN_PLAN_SAMPLES + level];
    if (samples == 0) {
        LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) store((real)0.0f, filtered, o + a * filteredLayout.z);
        return;
    }
    alike = ((level == plan[LW_SCREEN_PLAN_START] ? discsAlike : alike) & samples) != 0;
#endif
    lw_lit_row row;
    lw_lit_texel own;
    lit_row(&row, texels, texelLayout, light, lightLayout, x, y);
    load_lit(&own, &row, 0);
    const lw_surface s = make_surface(own.px, own.py, own.pz, own.nx, own.ny, own.nz);
    lw_light_sum sum;
    clear_sum(&sum);
    if (alike) {
        add_lit(&sum, ones_(s.valid), &own);
    } else if (any_(s.valid)) {
        const lw_lit_edges edges = lit_edges(&s);
        for (int j = max(-LW_REACH, -y); j <= min(LW_REACH, height - 1 - y); ++j) {
            lit_row(&row, texels, texelLayout, light, lightLayout, x, y + j);
            LW_UNROLL for (int i = -LW_REACH; i <= LW_REACH; ++i) {
                lw_lit_texel t;
                load_lit(&t, &row, i);
                add_lit(&sum, lit_weight(&edges, &t, window_weight(i) * window_weight(j)), &t);
            }
        }
    }
    const real scale = select_((real)0.0f, 1.0f / sum.weight, and_(s.valid, sum.weight > 0.0f));
    LW_UNROLL for (int a = 0; a < LW_LIGHT_PLANES; ++a) store(sum.v[a] * scale, filtered, o + a * filteredLayout.z);
}
