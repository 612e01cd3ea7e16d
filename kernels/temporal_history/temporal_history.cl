// Temporal history: each pixel's light is the mean over the last frames that saw the same surface,
//   F = c + (I - c) / (n + 1),    c = what the history W(F_prev) holds of the pixel, made to fit the frame (below),
// with n the frames in that mean (Soler et al. 2009 print I_prev for F_prev; the text describes this recursion). So a new
// pixel takes I as it is, a static view is the plain mean of its frames up to `frames`, and an exponential one after.
//
// W looks up the four history pixels around the place where the surface stood, and leaves out those that showed
// another one (position off the tangent plane, another normal). What is left is weighed anew.
//
// Light changes too, so a history is only believed as far as the last few frames allow. Of each surface's light Y (the sum of
// the channels) three more numbers are kept: m, the mean over three frames; b, over four, of Y - m, which is what Y changes by in
// three; and s, the noise that this surface shows from frame to frame: as many frames leave Y within s * light of m + b as twice
// those that leave it farther off against the sign of b. Noise leaps back; light that speeds up does not, and is not
// taken for noise. Frames are counted, not summed, since jumps of the light shall not weigh more than they are many. History is
// brought between the bounds (clamping, Karis 2014)
//   m + 2/3 b -+ gamma / 2 * s * light,
// and forgets where much of it was cut off, where a frame is more than some 5 deviations of Y away, or where b says that light is
// in motion. Bounds from the 3 x 3
// pixels around, the usual choice, do not work here: samples that all pixels share, such as VPLs, move whole
// patches up and down from frame to frame with next to no difference between neighbours, and at the edge of a moving
// shadow neighbours differ by all of its light.
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_weight.h"
#include "shared/history_types.h"
#include "recent_light.h"
#include "shared/surface_word.h"

#ifndef LW_SCALARS
#define LW_SCALARS 0  // 1-channel images beside the irradiance (validity, ambient occlusion): 0, 1, 2
#endif
#define LW_VALUES (3 + LW_SCALARS)
#define LW_KINDS (1 + LW_SCALARS)  // the irradiance, and each scalar
#define LW_MIXED (LW_VALUES + 3 * LW_KINDS)  // values, m of each kind, s, b
// Planes of a history: the mixed ones, position xyz, and a word of normal and age.
#define LW_POSITION_PLANE LW_MIXED
#define LW_WORD_PLANE (LW_MIXED + 3)
#include "shared/history_look_up.h"

// Speed in pixels a frame that halves the mean. Every look-up between pixels blurs a little; a short mean repeats that less
// often, and the eye resolves less in motion. Larger: blur in motion. Smaller: noise in motion.
#define LW_HALVING_SPEED 8.0f

// One work-item = LW_WIDTH adjacent pixels. current: 3 planes of irradiance and LW_SCALARS more. frames: in a mean at
// most, at least 1. gamma: of the bounds; 0: none. before, after: a history's planes (above), of the frame before at its
// size and of this one. counts[0]: surfaces without a history.
__kernel void temporal_history_blend(__global const float* position, int4 positionLayout, __global const float* normal,
                                     int4 normalLayout, int width, int height, __global const float* current,
                                     int4 currentLayout, __global const float* motion, int4 motionLayout, int mode,
                                     LwReprojection r, float frames, float gamma, __global const float* before,
                                     int4 beforeLayout, __global float* after, int4 afterLayout,
                                     __global float* irradiance, int4 irradianceLayout, __global float* first,
                                     int4 firstLayout, __global float* second, int4 secondLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask surface = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    real own[LW_VALUES];
    mask finite = surface;
    const int c0 = currentLayout.x + y * currentLayout.y + x;
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) {
        own[c] = load(current, c0 + c * currentLayout.z);
        finite = and_(finite, fabs(own[c]) <= LW_MOST_LIGHT);
    }
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) own[c] = select_((real)0.0f, own[c], finite);

    mask known = splat_mask(0), learnt = splat_mask(0);
    real age = (real)0.0f;
    real past[LW_MIXED];
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = (real)0.0f;
    if (mode != LW_HISTORY_NONE && any_(surface)) {
        real speed;
        const lw_past found = look_up(s, surface, x, y, mode, r, motion, motionLayout, before, beforeLayout, 0.0f, &speed);
        known = and_(surface, found.weight > LW_LEAST_WEIGHT);
        const real scale = select_((real)0.0f, 1.0f / found.weight, known);
        const real most = fmax(frames * LW_HALVING_SPEED / (LW_HALVING_SPEED + speed) - 1.0f, (real)0.0f);
        LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = found.mixed[c] * scale;
        age = select_((real)0.0f, fmin(floor(fma_(found.age, scale, (real)0.5f)), most), known);
        learnt = and_(known, or_(found.learnt * scale > 0.5f, age >= LW_LEARNING));
    }
    real share = (real)1.0f, m[LW_KINDS], noise[LW_KINDS], trend[LW_KINDS];
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        m[k] = past[LW_VALUES + k];
        noise[k] = past[LW_VALUES + LW_KINDS + k];
        trend[k] = past[LW_VALUES + 2 * LW_KINDS + k];
    }
    if (any_(known)) {
        const mask trusted = and_(splat_mask(gamma > 0.0f), and_(learnt, finite));
        real keep = (real)1.0f;
        LW_UNROLL for (int k = 0; k < LW_KINDS; ++k)
            keep = fmin(keep, follow(past + (k ? k + 2 : 0), own + (k ? k + 2 : 0), k ? 1 : 3, age, (real)gamma, trusted, &m[k], &noise[k], &trend[k]));
        // Where the noise is known half of the light stays what the bounds allow: a frame far off may be the only one such, and
        // would flash.
        age = fmax(age * keep, select_((real)0.0f, fmin(age, (real)1.0f), learnt));
        share = 1.0f / (age + 1.0f);
    }
    // A frame that is no number adds nothing to the history, and nothing comes of it without one.
    const mask follows = and_(known, finite);
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        const real whole = k ? own[k + 2] : own[0] + own[1] + own[2];
        m[k] = select_(select_(whole, past[LW_VALUES + k], known), m[k], follows);
        noise[k] = select_(select_((real)LW_FIRST_SPREAD, past[LW_VALUES + LW_KINDS + k], known), noise[k], follows);
        trend[k] = select_((real)0.0f, trend[k], follows);
    }

    const int o = afterLayout.x + y * afterLayout.y + x, plane = afterLayout.z;
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) {
        const real mean = select_(own[c], fma_(own[c] - past[c], select_((real)0.0f, share, finite), past[c]), known);
        store(mean, after, o + c * plane);
        if (c < 3) store(mean, irradiance, irradianceLayout.x + c * irradianceLayout.z + y * irradianceLayout.y + x);
        if (c == 3) store(mean, first, firstLayout.x + y * firstLayout.y + x);
        if (c == 4) store(mean, second, secondLayout.x + y * secondLayout.y + x);
    }
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        store(m[k], after, o + (LW_VALUES + k) * plane);
        store(noise[k], after, o + (LW_VALUES + LW_KINDS + k) * plane);
        store(trend[k], after, o + (LW_VALUES + 2 * LW_KINDS + k) * plane);
    }
    store(s.px, after, o + LW_POSITION_PLANE * plane);
    store(s.py, after, o + (LW_POSITION_PLANE + 1) * plane);
    store(s.pz, after, o + (LW_POSITION_PLANE + 2) * plane);
    const lanei grown = to_lanei(fmax(age + select_((real)0.0f, (real)1.0f, finite), (real)1.0f) + 0.5f);
    store(pack_word(s.nx, s.ny, s.nz, selecti_((lanei)0, grown, or_(known, finite)), learnt), (__global uint*)after, o + LW_WORD_PLANE * plane);
    const mask fresh = and_(surface, not_(known));
    if (any_(fresh)) atomic_add(counts, count_(fresh));
}

// For debugging, one work-item = LW_WIDTH adjacent pixels: frames in the mean of each, 0 without a surface.
__kernel void temporal_history_age(__global const float* history, int4 layout, int width, int height, __global float* age,
                                   int4 ageLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const laneu word = as_laneu_(loadi((__global const int*)history, layout.x + LW_WORD_PLANE * layout.z + y * layout.y + x));
    store(age_of(word), age, ageLayout.x + y * ageLayout.y + x);
}
