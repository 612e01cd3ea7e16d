// Samples of a volume of voxels at LW_WIDTH places: one level, interpolated between eight voxels.
//
// LW_CONE_MODE: 0 isotropic, 1 anisotropic, 2 two bands of harmonics. LW_CONE_SIDES 1: the finest level has six sides. LW_CONE_LIGHT
// 0: opacity alone. LW_CONE_VOXELS: 8, or 4, between which a place is interpolated.
#ifndef LW_CONE_VOLUME_H
#define LW_CONE_VOLUME_H

#include "cone_between.h"
#include "cone_corner.h"
#include "shared/cone_types.h"
#include "shared/voxel_format.h"
#include "shared/wide.h"

#ifndef LW_CONE_MODE
#define LW_CONE_MODE 0
#endif
#ifndef LW_CONE_SIDES
#define LW_CONE_SIDES 0
#endif
#ifndef LW_CONE_LIGHT
#define LW_CONE_LIGHT 1
#endif

// Of one cascade.
typedef struct {
    LwConeGrids grids;
    __global const int* table;
    __global const uint* base;
    __global const uint* mips;
    int unit;
} cone_volume;

// Premultiplied; and `spread` over `most`: how much of a is in closed voxels, 1, or spread over all, 0. They are the variance of opacity
// among the voxels that were interpolated, and what it would be if each were open or closed; one division is left to who needs their ratio.
typedef struct { real r, g, b, a, spread, most; } cone_sample;

// Fields of a word as fractions behind a leading 1: no conversion, and a mask, a constant and a field are one operation. What the ones
// bring is added up as well and taken off the sum (finish_words), so that a field that is 0 in all words stays 0 exactly. Blue lies lowest,
// 2^-7 of the one, and is off by 1e-5 of its largest at most; in its place in the word it would be off by 1 %.
#define LW_CONE_ONE 0x3f800000u
#define LW_CONE_LEAST_EXPONENT 0x20000000u  // 64: an exponent's 5 bits are or-ed to it
// From a fraction to the mantissa: opacity over 255, colours over u.
#define LW_CONE_OPACITY_STEP (256.0f / 255.0f)
#define LW_CONE_RED_STEP 1024.0f
#define LW_CONE_GREEN_STEP 64.0f
#define LW_CONE_BLUE_STEP 8192.0f

typedef struct { real r, g, b, a, ones, squares; } cone_words;  // squares: of the opacity's fractions with their ones
LW_FN real fraction(laneu word, uint field, laneu one) { return as_real_((word & field) | one); }
LW_FN laneu exponent_of(laneu low) { return (low & LW_VOXEL_EXPONENT_MASK) | (laneu)LW_CONE_LEAST_EXPONENT; }

// One word's share of a sum, with the ones.
LW_FN void add_word(cone_words* sum, laneu word, real weight) {
    const laneu low = word >> LW_VOXEL_EXPONENT_SHIFT;
    const real opacity = fraction(low, LW_VOXEL_OPACITY_MASK >> LW_VOXEL_EXPONENT_SHIFT, (laneu)LW_CONE_ONE), share = opacity * weight;
    sum->a += share;
    sum->squares = fma_(opacity, share, sum->squares);
#if LW_CONE_LIGHT
    const laneu one = exponent_of(low), high = word << 10;
    sum->ones = fma_(as_real_(one), weight, sum->ones);
    sum->r = fma_(fraction(word, LW_VOXEL_RED_MASK, one), weight, sum->r);
    sum->g = fma_(fraction(high, LW_VOXEL_GREEN_MASK << 10, one), weight, sum->g);
    sum->b = fma_(fraction(high, LW_VOXEL_BLUE_MASK << 10, one), weight, sum->b);
#endif
}

// The words of one plane that each lane lies between onto the sum. Neighbouring pixels' cones are mostly between the same voxels from a
// few levels on; of a level that is one voxel there is one word.
LW_FN void add_plane(cone_words* sum, __global const uint* words, const cone_corner* c, lanei at, const cone_between* b) {
    const int first = firsti_lane(at), shared = c->shared && !any_(at != (lanei)first);
    if (shared && c->side == 1) {
        add_word(sum, (laneu)words[first], b->sum);
        return;
    }
    laneu found[LW_CONE_VOXELS];
    if (shared) load_shared(found, words + first, b);
    else load_words(found, words, at, b);
    LW_UNROLL for (int k = 0; k < LW_CONE_VOXELS; ++k) add_word(sum, found[k], b->w[k]);
}

LW_FN void begin_words(cone_words* sum) { sum->r = sum->g = sum->b = sum->a = sum->ones = sum->squares = (real)0.0f; }

// Opacity's variance, and what it would be of open and closed voxels alone, times 255/256 squared. ones: the sum of weights; of has, 1 or 0, the
// rest is empty.
LW_FN void spread_of(real* variance, real* most, const cone_words* sum, real ones, real has) {
    const real a = sum->a - ones;
    *variance = sum->squares - fma_((real)2.0f, a, ones) - a * a;
    *most = a * (has * (1.0f / LW_CONE_OPACITY_STEP) - a);
}
LW_FN void keep_spread(cone_sample* sample, real variance, real most) {
    sample->most = greater(most, (real)1e-6f);
    sample->spread = lesser(greater(variance, (real)0.0f), sample->most);
}

// ones: the sum of weights.
LW_FN void finish_words(cone_sample* sample, const cone_words* sum, real ones, int unit) {
    sample->a = clamp((sum->a - ones) * LW_CONE_OPACITY_STEP, (real)0.0f, (real)1.0f);
#if LW_CONE_LIGHT
    const float scale = as_float(unit + ((127 << 23) - (int)LW_CONE_LEAST_EXPONENT));
    // In this order: a step times the scale may leave float's range.
    sample->r = (sum->r - sum->ones) * LW_CONE_RED_STEP * scale;
    sample->g = (sum->g - sum->ones) * LW_CONE_GREEN_STEP * scale;
    sample->b = (sum->b - sum->ones) * LW_CONE_BLUE_STEP * scale;
#endif
}

// The plane of an axis that a ray meets, seen at the cosine of its angle to that axis; `closed`: the largest share of a voxel's side that
// something covers; `ones`: of opacity's sum.
LW_FN void add_side(cone_words* sum, real* closed, real* ones, real* variance, real* most, __global const uint* words, const cone_corner* c,
                    const cone_between* b, int plane, real d, real has) {
    const real cosine = fabs(d);
    cone_words side;
    begin_words(&side);
    add_plane(&side, words, c, c->at + selecti_((lanei)0, (lanei)plane, d > (real)0.0f), b);
    sum->a = fma_(cosine, side.a, sum->a);
    sum->r = fma_(cosine, side.r, sum->r);
    sum->g = fma_(cosine, side.g, sum->g);
    sum->b = fma_(cosine, side.b, sum->b);
    sum->ones = fma_(cosine, side.ones, sum->ones);
    *ones = fma_(cosine, b->sum, *ones);
    *closed = fmax(*closed, side.a - b->sum);
    real v, m;
    spread_of(&v, &m, &side, b->sum, has);
    *variance = fma_(cosine, v, *variance);
    *most = fma_(cosine, m, *most);
}

// Three of six sides. Small surfaces, A of them facing an axis, take A |d| of a step's light: x in all. Where they close a share F of the
// voxel's side, a ray has 1 / |d| steps' length to get through the layer: x / (1 - F + x) is x for small F, and 1 for a closed wall however
// it is met. (By the squares of the direction's components, as is usual, a closed wall that is met at 60 degrees to its normal
// takes a quarter of a step's light, and more than half gets through: 64 cones then leave the Cornell box 24 % too dark at any size.)
LW_FN void sample_sides(cone_sample* sample, __global const uint* words, const cone_corner* c, int plane, real dx, real dy, real dz, real has,
                        int unit) {
    cone_words sum;
    begin_words(&sum);
    cone_between b;
    between(&b, c, has);
    real closed = (real)0.0f, ones = (real)0.0f, variance = (real)0.0f, most = (real)0.0f;
    add_side(&sum, &closed, &ones, &variance, &most, words, c, &b, plane, dx, has);
    add_side(&sum, &closed, &ones, &variance, &most, words + 2 * plane, c, &b, plane, dy, has);
    add_side(&sum, &closed, &ones, &variance, &most, words + 4 * plane, c, &b, plane, dz, has);
    finish_words(sample, &sum, ones, unit);
    const real taken = fmax((sum.a - ones) * LW_CONE_OPACITY_STEP, (real)0.0f);
    const real share = 1.0f / fmax(taken + (1.0f - fmin(closed * LW_CONE_OPACITY_STEP, (real)1.0f)), (real)1e-6f);
    sample->a = fmin(taken * share, (real)1.0f);
    // A word's opacity is in whole steps, so that 0 may stand for less than one and have light. That must not grow with the share that a
    // closed side has which the ray hardly meets: voxels would light themselves at several times what they send (with all bounces, without end).
    const real bright = lesser(share, greater(taken * share * 255.0f, (real)1.0f));
    sample->r *= bright;
    sample->g *= bright;
    sample->b *= bright;
    keep_spread(sample, variance, most);
}

#if LW_CONE_MODE == 2 && LW_CONE_LIGHT
#define LW_CONE_SHARE (3.0f * 0.2820947918f / 511.0f)
LW_FN real along(laneu word, real dx, real dy, real dz) {
    const real x = to_real(as_lanei_(word & 1023u)), y = to_real(as_lanei_((word >> 10) & 1023u)), z = to_real(as_lanei_((word >> 20) & 1023u));
    return fma_(x, dx, fma_(y, dy, z * dz));
}
// L = Y0 c0 (1 + 3 share . d), d against the ray, of each voxel before it is interpolated: the product is linear in what was filtered.
LW_FN void add_harmonics(cone_sample* sum, __global const uint* words, const cone_corner* c, int plane, real dx, real dy, real dz, real has,
                         int unit) {
    cone_between b;
    between(&b, c, has);
    laneu found[4][LW_CONE_VOXELS];
    LW_UNROLL for (int k = 0; k < 4; ++k) load_words(found[k], words + k * plane, c->at, &b);
    // The fields are 511 for 0.
    const real even_light = fma_((real)(511.0f * LW_CONE_SHARE), dx + dy + dz, (real)0.2820947918f);
    LW_UNROLL for (int i = 0; i < LW_CONE_VOXELS; ++i) {
        const laneu w = found[0][i];
        const real weight = b.w[i], step = weight * as_real_(((w >> LW_VOXEL_EXPONENT_SHIFT) & LW_VOXEL_EXPONENT_MASK) + (uint)unit);
        const real opacity = to_real(as_lanei_(w & LW_VOXEL_OPACITY_MASK)) * LW_VOXEL_OPACITY_STEP, share = opacity * weight;
        const laneu red = found[1][i], green = found[2][i], blue = found[3][i];
        sum->a += share;
        sum->spread = fma_(opacity, share, sum->spread);
        sum->r = fma_(to_real(as_lanei_(w & LW_VOXEL_RED_MASK)) * step, fma_((real)-LW_CONE_SHARE, along(red, dx, dy, dz), even_light), sum->r);
        sum->g = fma_(to_real(as_lanei_(w & LW_VOXEL_GREEN_MASK)) * step, fma_((real)-LW_CONE_SHARE, along(green, dx, dy, dz), even_light), sum->g);
        sum->b = fma_(to_real(as_lanei_(w & LW_VOXEL_BLUE_MASK)) * step, fma_((real)-LW_CONE_SHARE, along(blue, dx, dy, dz), even_light), sum->b);
    }
}
#endif

// Light and opacity between a corner's voxels, seen by a ray that goes along d.
LW_FN void sample_corner(cone_sample* sample, const cone_volume* v, int level, const cone_corner* c, real dx, real dy, real dz) {
    const real has = ones_(c->has), none = (real)0.0f;
    sample->r = sample->g = sample->b = sample->a = sample->spread = none;
    sample->most = (real)1.0f;
    __global const uint* words = level == 0 ? v->base : v->mips;
    const int plane = level == 0 ? v->grids.basePlane : v->grids.mipPlane;
#if LW_CONE_MODE == 2 && LW_CONE_LIGHT
    if (level > 0 || !LW_CONE_SIDES) {
        add_harmonics(sample, words, c, plane, dx, dy, dz, has, v->unit);
        keep_spread(sample, sample->spread - sample->a * sample->a, sample->a * (1.0f - sample->a));
        sample->a = fmin(sample->a, (real)1.0f);
        sample->r = fmax(sample->r * LW_VOXEL_RED_STEP, none);
        sample->g = fmax(sample->g * LW_VOXEL_GREEN_STEP, none);
        sample->b = fmax(sample->b * LW_VOXEL_BLUE_STEP, none);
        return;
    }
#endif
    if (level == 0 ? LW_CONE_SIDES : LW_CONE_MODE == 1) {
        sample_sides(sample, words, c, plane, dx, dy, dz, has, v->unit);
        return;
    }
    cone_words sum;
    begin_words(&sum);
    cone_between b;
    between(&b, c, has);
    add_plane(&sum, words, c, c->at, &b);
    finish_words(sample, &sum, b.sum, v->unit);
    real variance, most;
    spread_of(&variance, &most, &sum, b.sum, has);
    keep_spread(sample, variance, most);
}

#endif
