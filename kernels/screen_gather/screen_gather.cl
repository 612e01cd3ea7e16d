// Indirect light of one level of a G-buffer's mip pyramid (Soler et al. 2009, section 3.2): every texel gathers a few
// texels around it, each standing for a known number of texels' area, with the bounded point-to-disc term of
// docs/conventions.md instead of the paper's eq. 4. Visibility is not asked for.
//
// Each texel of an n x n block (n = LW_INTERLEAVE) has a sample pattern of its own. A level is dealt: column x lies in
// segment x mod n of its row, so that texels with one pattern, n columns apart, stand side by side, and a sample is
// one contiguous load for all lanes.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4
#endif
#ifndef LW_PLANNED
#define LW_PLANNED 0  // 1: the plan of the frame says which levels are gathered, and with how many samples
#endif
#include "shared/wide.h"
#include "shared/interleave.h"
#include "shared/screen_plan_types.h"
#include "shared/screen_types.h"
#include "shared/surface.h"

// Dealt layout: x first float of segment 0's first column, y row stride, z plane stride, w distance of segments.
// Before each segment and behind the last there are LW_PYRAMID_BORDER columns without a surface.

// One work-item = LW_INTERLEAVE * LW_WIDTH texels of one row, all planes of senders. A level that is not gathered is not dealt.
__kernel void screen_gather_deal(__global const float* level, int4 levelLayout, int width, int height,
                                 __global float* dealt, int4 dealtLayout
#if LW_PLANNED
                                 , __global const int* plan, int planned
#endif
) {
#if LW_PLANNED
    if (plan[LW_SCREEN_PLAN_SAMPLES + planned] == 0) return;
#endif
    const int i = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1), x = i * LW_INTERLEAVE;
    if (x >= width || y >= height) return;
    for (int plane = 0; plane < LW_SENDER_PLANES; ++plane) {
        real v[LW_INTERLEAVE];
        load_dealt(v, level, levelLayout.x + plane * levelLayout.z + y * levelLayout.y, x, width);
        if (plane == LW_SENDER_AREA)  // negative: receives only
            LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) v[phase] = fmax(v[phase], (real)0.0f);
        const int at = dealtLayout.x + plane * dealtLayout.z + y * dealtLayout.y + i;
        LW_UNROLL for (int phase = 0; phase < LW_INTERLEAVE; ++phase) store(v[phase], dealt, at + phase * dealtLayout.w);
    }
}

typedef struct { real r, g, b, share; } lw_gathered;

// Two samples at once, whose chains of dependent operations overlap. With C = c d and C_p = c_p d a sample of area A is
// w A = C C_p A / (d^4 + (d^2 + 3 C_p^2) A / 4 pi) of the hemisphere times pi; `bound`: 1 / 4 pi, or 0 for the unbounded
// term. The smallest float keeps the receiver's own texel at 0 / tiny = 0.
LW_FN void add_two_samples(lw_gathered* sum, const lw_surface s, __global const float* dealt, const int* at, int plane,
                           const float* weight, float bound) {
    real dx[2], dy[2], dz[2], d2[2], c[2], w[2], area[2];
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        dx[u] = load(dealt, at[u]) - s.px;
        dy[u] = load(dealt, at[u] + plane) - s.py;
        dz[u] = load(dealt, at[u] + 2 * plane) - s.pz;
        area[u] = load(dealt, at[u] + LW_SENDER_AREA * plane) * weight[u];
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) d2[u] = fma_(dx[u], dx[u], fma_(dy[u], dy[u], dz[u] * dz[u]));
    LW_UNROLL for (int u = 0; u < 2; ++u) c[u] = fmax(fma_(dx[u], s.nx, fma_(dy[u], s.ny, dz[u] * s.nz)), (real)0.0f);
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        const real back = fma_(dx[u], load(dealt, at[u] + 3 * plane),
                               fma_(dy[u], load(dealt, at[u] + 4 * plane), dz[u] * load(dealt, at[u] + 5 * plane)));
        w[u] = fmax(-back, (real)0.0f);
    }
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        const real edge = fma_(fma_(3.0f * w[u], w[u], d2[u]), area[u] * bound, 1e-37f);
        w[u] = fmin(c[u] * w[u] * area[u] / fma_(d2[u], d2[u], edge), (real)LW_LARGEST_SAMPLE);
        sum->r = fma_(w[u], load(dealt, at[u] + LW_SENDER_RADIANCE * plane), sum->r);
        sum->g = fma_(w[u], load(dealt, at[u] + (LW_SENDER_RADIANCE + 1) * plane), sum->g);
        sum->b = fma_(w[u], load(dealt, at[u] + (LW_SENDER_RADIANCE + 2) * plane), sum->b);
        sum->share += w[u];
    }
}

// Where a sample's texels stand, for LW_WIDTH receivers from column i of segment `phase` on; -1: all are off the image,
// and a sample off the image contributes nothing.
LW_FN int sample_at(const LwScreenSample s, int phase, int i, int y, int columns, int height, int4 layout) {
    const int column = i + s.step + (phase + s.phase >= LW_INTERLEAVE ? 1 : 0);
    const int row = y + s.row, segment = (phase + s.phase) & (LW_INTERLEAVE - 1);
    if (row < 0 || row >= height || column <= -LW_WIDTH || column >= columns || s.weight == 0.0f) return -1;
    return layout.x + row * layout.y + segment * layout.w + column;
}

// One work-item = LW_WIDTH texels with one pattern: columns LW_INTERLEAVE apart of one row. samples: pairs, of
// LW_INTERLEAVE^2 patterns. light: LW_LIGHT_PLANES planes of the level, columns as in the image. plan: by level, how many samples it
// takes; `samples` then has the patterns of sampleCount, of half of it, and so on, and `discs` those for the level that the
// picture starts with.
__kernel void screen_gather_gather(__global const float* dealt, int4 dealtLayout, int width, int height,
                                   __global const LwScreenSample* samples, int sampleCount, float bound,
                                   __global float* light, int4 lightLayout
#if LW_PLANNED
                                   , __global const LwScreenSample* discs, __global const int* plan, int level
#endif
) {
#if LW_PLANNED
    const int most = sampleCount;
    sampleCount = plan[LW_SCREEN_PLAN_SAMPLES + level];
    if (LW_INTERLEAVE > 1 && sampleCount == 0) return;  // the filter clears the light
    if (level == plan[LW_SCREEN_PLAN_START]) samples = discs;
    samples += 2 * LW_INTERLEAVE * LW_INTERLEAVE * (most - sampleCount);
#endif
    const int columns = (width + LW_INTERLEAVE - 1) / LW_INTERLEAVE, vectors = (columns + LW_WIDTH - 1) / LW_WIDTH;
    const int phase = (int)get_global_id(0) / vectors, i = ((int)get_global_id(0) % vectors) * LW_WIDTH;
    const int y = (int)get_global_id(1);
    if (phase >= LW_INTERLEAVE || y >= height || i * LW_INTERLEAVE + phase >= width) return;
    const int plane = dealtLayout.z, own = dealtLayout.x + y * dealtLayout.y + phase * dealtLayout.w + i;
    lw_surface s;
    s.px = load(dealt, own);
    s.py = load(dealt, own + plane);
    s.pz = load(dealt, own + 2 * plane);
    s.nx = load(dealt, own + 3 * plane);
    s.ny = load(dealt, own + 4 * plane);
    s.nz = load(dealt, own + 5 * plane);
    s.valid = squared_length(s.nx, s.ny, s.nz) > 0.25f;
    lw_gathered sum = {(real)0.0f, (real)0.0f, (real)0.0f, (real)0.0f};
    if (any_(s.valid)) {
        const int nowhere = dealtLayout.x - LW_PYRAMID_BORDER;  // no surface
        samples += ((y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + phase) * sampleCount;
        for (int k = 0; k < sampleCount; k += 2) {
            int at[2];
            at[0] = sample_at(samples[k], phase, i, y, columns, height, dealtLayout);
            at[1] = sample_at(samples[k + 1], phase, i, y, columns, height, dealtLayout);
            if (at[0] < 0 && at[1] < 0) continue;
            const float weight[2] = {samples[k].weight, samples[k + 1].weight};
            LW_UNROLL for (int u = 0; u < 2; ++u) at[u] = at[u] < 0 ? nowhere : at[u];
            add_two_samples(&sum, s, dealt, at, plane, weight, bound);
        }
    }
    const real limit = (real)LW_LARGEST_IRRADIANCE;
    const lanei to = (lanei)(lightLayout.x + y * lightLayout.y + i * LW_INTERLEAVE + phase) + lanei_iota() * LW_INTERLEAVE;
    scatter(select_((real)0.0f, fmin(sum.r, limit), s.valid), light, to);
    scatter(select_((real)0.0f, fmin(sum.g, limit), s.valid), light, to + lightLayout.z);
    scatter(select_((real)0.0f, fmin(sum.b, limit), s.valid), light, to + 2 * lightLayout.z);
    scatter(select_((real)0.0f, sum.share * M_1_PI_F, s.valid), light, to + LW_LIGHT_SHARE * lightLayout.z);
}
