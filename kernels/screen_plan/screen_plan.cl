// How many samples each level of technique screen_space needs. A few receivers take the light of every texel of a coarse
// level, which is cheap and without noise, ring by ring: so much a level brings, so much of it a smaller number of
// samples loses to the bound of the form factor, and so much its samples differ. What is decided depends on the frames since the
// last cut and on nothing else; each lane is a receiver of its own and sums in one order, so that the same frames have the same
// bits at every width.
#ifndef LW_LEVELS
#define LW_LEVELS 4  // 1 .. 6
#endif
#include "shared/screen_plan_types.h"
#ifndef LW_ASKED_HALVINGS
#define LW_ASKED_HALVINGS LW_PROBED_HALVINGS  // fewer where there is no coarser start: the others' planes are then not written
#endif
#include "shared/screen_types.h"
#include "shared/surface.h"
#include "shared/wide.h"

#define LW_UNROLL _Pragma("unroll")

// Radiance below which a picture is dark: its inverse is no number that float has.
#define LW_DARK_RADIANCE 1e-30f

LW_FN float mean_radiance(__global const float* level, int at, int plane) {
    return (level[at + LW_SENDER_RADIANCE * plane] + level[at + (LW_SENDER_RADIANCE + 1) * plane] +
            level[at + (LW_SENDER_RADIANCE + 2) * plane]) * (1.0f / 3.0f);
}

// One work-item = one of the rows that are asked, every `step`th: radiance of its brightest texel.
__kernel void screen_plan_rows(__global const float* level, int4 layout, int width, int height, int step, __global float* brightest) {
    const int row = (int)get_global_id(0), y = row * step;
    if (y >= height) return;
    float most = 0.0f;
    for (int x = 0; x < width; x += step) most = fmax(most, mean_radiance(level, layout.x + y * layout.y + x, layout.z));
    brightest[row] = most;
}

typedef struct {
    real light[LW_LEVELS], loss[LW_ASKED_HALVINGS][LW_LEVELS], squares[LW_LEVELS], share[LW_LEVELS];
} lw_probed;

// One texel of `area` and radiance l: the bounded term of screen_gather with samples of any number, whose bound is what a sample stands
// for, but at least a texel of its level. `inside`: the ring of each lane's texel.
LW_FN real bounded_sample(real numerator, real d4, real edge, real standsFor, float bound) {
    return fmin(numerator / (d4 + fma_(edge, standsFor * bound, (real)1e-37f)), (real)LW_LARGEST_SAMPLE);
}

LW_FN void add_texel(lw_probed* sum, const mask* inside, const real* standsFor, real edge, real d4, real numerator, float l, float bound) {
    real w[LW_ASKED_HALVINGS + 1];
    w[0] = bounded_sample(numerator, d4, edge, standsFor[0], bound);
    LW_UNROLL for (int k = 0; k < LW_LEVELS; ++k) sum->share[k] = fma_(ones_(inside[k]), w[0], sum->share[k]);
    if (!(l > 0.0f)) return;  // divisions take most of the time, and most of a picture may be in the shade
    LW_UNROLL for (int c = 1; c <= LW_ASKED_HALVINGS; ++c) w[c] = bounded_sample(numerator, d4, edge, standsFor[c], bound);
    LW_UNROLL for (int k = 0; k < LW_LEVELS; ++k) {
        const real here = ones_(inside[k]), whole = here * w[0];
        sum->light[k] = fma_(whole, (real)l, sum->light[k]);
        sum->squares[k] = fma_(whole * l, w[0] * l, sum->squares[k]);
        LW_UNROLL for (int c = 0; c < LW_ASKED_HALVINGS; ++c)
            sum->loss[c][k] = fma_(here * (w[0] - w[c + 1]), (real)l, sum->loss[c][k]);
    }
}

// One work-item = LW_WIDTH receivers of one row of them: every `turns`th, from `turn` on. samples: the most. bound: as of
// screen_gather, or 0.
__kernel void screen_plan_probe(__global const float* level, int4 layout, int width, int height, int step,
                                __global const float* brightest, int samples, float bound, LwScreenRings rings, int turn,
                                int turns, __global float* probed) {
    const int column = (int)get_global_id(0) * LW_WIDTH, row = turn + (int)get_global_id(1) * turns;
    if (column >= LW_PROBE_COLUMNS || row >= LW_PROBE_ROWS) return;
    const int plane = layout.z, ry = (2 * row + 1) * height / (2 * LW_PROBE_ROWS);
    const lanei rx = (2 * (lanei_iota() + (lanei)column) + 1) * width / (2 * LW_PROBE_COLUMNS);
    const lanei own = rx + (lanei)(layout.x + ry * layout.y);
    const real px = gather(level, own), py = gather(level, own + plane), pz = gather(level, own + 2 * plane);
    const real nx = gather(level, own + 3 * plane), ny = gather(level, own + 4 * plane), nz = gather(level, own + 5 * plane);
    float most = 0.0f;
    for (int y = 0; y * step < height; ++y) most = fmax(most, brightest[y]);
    const float scale = most > LW_DARK_RADIANCE ? 1.0f / most : 0.0f, texels = (float)(step * step);
    lw_probed sum;
    LW_UNROLL for (int k = 0; k < LW_LEVELS; ++k) {
        sum.light[k] = sum.squares[k] = sum.share[k] = (real)0.0f;
        LW_UNROLL for (int c = 0; c < LW_ASKED_HALVINGS; ++c) sum.loss[c][k] = (real)0.0f;
    }
    for (int y = 0; y < height; y += step)
        for (int x = 0; x < width; x += step) {
            const int at = layout.x + y * layout.y + x;
            const float area = level[at + LW_SENDER_AREA * plane];
            if (!(area > 0.0f)) continue;  // no surface, or one that only receives
            const real dx = level[at] - px, dy = level[at + plane] - py, dz = level[at + 2 * plane] - pz;
            const real c = fma_(dx, nx, fma_(dy, ny, dz * nz));
            const real cp = -fma_(dx, (real)level[at + 3 * plane], fma_(dy, (real)level[at + 4 * plane], dz * level[at + 5 * plane]));
            const mask faces = and_(c > 0.0f, cp > 0.0f);
            if (!any_(faces)) continue;
            const real across = to_real((lanei)x - rx), down = (real)(float)(y - ry);
            const real off2 = fma_(across, across, down * down), d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
            mask inside[LW_LEVELS], within = splat_mask(0);
            real standsFor[LW_ASKED_HALVINGS + 1];
            LW_UNROLL for (int i = 0; i <= LW_ASKED_HALVINGS; ++i) standsFor[i] = (real)0.0f;
            LW_UNROLL for (int k = 0; k < LW_LEVELS; ++k) {
                const mask out = off2 < rings.outer2[k];
                inside[k] = and_(faces, and_(out, not_(within)));
                within = out;
                // In texels that are asked: what one of the level's samples stands for.
                const float own_texel = rings.area[k] / rings.texels[k];
                LW_UNROLL for (int i = 0; i <= LW_ASKED_HALVINGS; ++i) {
                    const float each = fmax(rings.texels[k] * (float)(1 << i) / (float)samples, 1.0f) * own_texel;
                    standsFor[i] = select_(standsFor[i], (real)(each * area), inside[k]);
                }
            }
            const real numerator = select_((real)0.0f, c * cp * (area * texels), faces);
            add_texel(&sum, inside, standsFor, fma_(3.0f * cp, cp, d2), d2 * d2, numerator, mean_radiance(level, at, plane) * scale, bound);
        }
    if (column == 0) probed[LW_PROBED_UNITS + row] = scale > 0.0f ? most : 0.0f;
    // A texel that stands for those stepped over has the square of their sum, not the sum of their squares.
    const int to = row * LW_PROBE_COLUMNS + column;
    LW_UNROLL for (int k = 0; k < LW_LEVELS; ++k) {
        __global float* out = probed + k * LW_PROBED_PLANES * LW_PROBES + to;
        store(sum.light[k], out, LW_PROBED_LIGHT * LW_PROBES);
        LW_UNROLL for (int c = 0; c < LW_ASKED_HALVINGS; ++c) store(sum.loss[c][k], out, (LW_PROBED_LOSS + c) * LW_PROBES);
        store(sum.squares[k] / texels, out, LW_PROBED_SQUARES * LW_PROBES);
        store(sum.share[k] * M_1_PI_F, out, LW_PROBED_SHARE * LW_PROBES);
    }
}
