// What a view showed last, followed to where its surfaces stand now, mixed with what it is to show: F = c + s (I - c), s the share of
// the new. Where the last picture did not show the surface, the new light alone. With s = 1/k, 1/(k - 1), .. 1 in k frames, each mixing
// what the one before showed, a steady I is reached in k even steps.
#include "shared/input_limits.h"
#include "shared/wide.h"
#include "shared/surface.h"

// Planes of a picture: irradiance, validity, position xyz, a word of normal and age (1: a surface, 0: none).
#define LW_MIXED 4
#define LW_POSITION_PLANE LW_MIXED
#define LW_WORD_PLANE (LW_MIXED + 3)
#include "shared/history_look_up.h"

// One work-item = LW_WIDTH adjacent pixels. irradiance: 3 planes, validity: 1, both new; hasIrradiance, hasValidity: which of them are
// wanted: the others' arguments are not touched, and stand as 0 in a picture. mode: LW_HISTORY_*. share: of the new, above 0. rounding: as
// look_up's, above 0: bilinear mixing is four times the gathers, and a blur in every frame of a fade. before,
// after: pictures, of the frame before at its size and of this one. shownIrradiance, shownValidity: what the view shows.
// counts[0]: surfaces that the last picture did not show, of a share below 1: else it is not looked at.
__kernel void cross_fade_mix(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                             int width, int height, __global const float* irradiance, int4 irradianceLayout,
                             __global const float* validity, int4 validityLayout, int hasIrradiance, int hasValidity,
                             __global const float* motion, int4 motionLayout, int mode, LwReprojection r, float share, float rounding,
                             __global const float* before, int4 beforeLayout, __global float* after, int4 afterLayout,
                             __global float* shownIrradiance, int4 shownIrradianceLayout, __global float* shownValidity,
                             int4 shownValidityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask surface = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    real own[LW_MIXED];
    const int e = irradianceLayout.x + y * irradianceLayout.y + x;
    LW_UNROLL for (int c = 0; c < 3; ++c) own[c] = hasIrradiance ? load(irradiance, e + c * irradianceLayout.z) : (real)0.0f;
    own[3] = hasValidity ? load(validity, validityLayout.x + y * validityLayout.y + x) : (real)0.0f;
    mask finite = surface;
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) finite = and_(finite, fabs(own[c]) <= LW_LARGEST_IRRADIANCE);

    mask known = splat_mask(0);
    real past[LW_MIXED];
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = (real)0.0f;
    if (mode != LW_HISTORY_NONE && any_(surface)) {
        real speed;
        const lw_past found = look_up(s, surface, x, y, mode, r, motion, motionLayout, before, beforeLayout, rounding, &speed);
        known = and_(finite, found.weight > LW_LEAST_WEIGHT);
        const real scale = select_((real)0.0f, 1.0f / found.weight, known);
        LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = found.mixed[c] * scale;
    }

    const int o = afterLayout.x + y * afterLayout.y + x, plane = afterLayout.z;
    // The last step is the new light to the bit.
    const mask mixes = and_(known, splat_mask(share < 1.0f));
    real shown[LW_MIXED];
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) {
        shown[c] = select_(own[c], fma_(own[c] - past[c], (real)share, past[c]), mixes);
        store_past(select_((real)0.0f, shown[c], finite), after, o + c * plane);
    }
    if (hasIrradiance)
        LW_UNROLL for (int c = 0; c < 3; ++c)
            store_past(shown[c], shownIrradiance, shownIrradianceLayout.x + c * shownIrradianceLayout.z + y * shownIrradianceLayout.y + x);
    if (hasValidity) store_past(shown[3], shownValidity, shownValidityLayout.x + y * shownValidityLayout.y + x);
    store_past(s.px, after, o + LW_POSITION_PLANE * plane);
    store_past(s.py, after, o + (LW_POSITION_PLANE + 1) * plane);
    store_past(s.pz, after, o + (LW_POSITION_PLANE + 2) * plane);
    const lanei age = selecti_((lanei)0, (lanei)1, finite);
    store_past(as_real_(pack_word(s.nx, s.ny, s.nz, age, splat_mask(0))), after, o + LW_WORD_PLANE * plane);
    const mask fresh = and_(surface, not_(known));
    if (share < 1.0f && any_(fresh)) atomic_add(counts, count_(fresh));
}
