// Words of voxels (voxel_format.h) in lanes: weighted sums of them, as a trilinear sample takes. Fields
// stay where they lie in the word, and only the finished sum is scaled: three operations for each field
// of a word.
#ifndef LW_VOXEL_FORMAT_WIDE_H
#define LW_VOXEL_FORMAT_WIDE_H

#include "voxel_format.h"
#include "wide.h"

// A word's field as floats, unshifted: below 2^27, so signed numbers hold it.
#define voxel_field(word, bits) to_real(as_lanei_((word) & (laneu)(bits)))

// 2^e u of each word, times its weight. unit: LwVoxelState's.
LW_FN real voxel_step(laneu word, int unit, real weight) {
    return as_real_((word >> (laneu)LW_VOXEL_EXPONENT_SHIFT & (laneu)LW_VOXEL_EXPONENT_MASK) +
                    (laneu)(uint)unit) *
           weight;
}

// Adds a weighted word to a sum of red, green, blue and opacity, which is not scaled yet.
LW_FN void voxel_add(laneu word, int unit, real weight, real* sum) {
    const real step = voxel_step(word, unit, weight);
    sum[0] = fma_(voxel_field(word, LW_VOXEL_RED_MASK), step, sum[0]);
    sum[1] = fma_(voxel_field(word, LW_VOXEL_GREEN_MASK), step, sum[1]);
    sum[2] = fma_(voxel_field(word, LW_VOXEL_BLUE_MASK), step, sum[2]);
    sum[3] = fma_(voxel_field(word, LW_VOXEL_OPACITY_MASK), weight, sum[3]);
}
// To premultiplied radiance and opacity.
LW_FN void voxel_scale(real* sum) {
    sum[0] *= LW_VOXEL_RED_STEP;
    sum[1] *= LW_VOXEL_GREEN_STEP;
    sum[2] *= LW_VOXEL_BLUE_STEP;
    sum[3] *= LW_VOXEL_OPACITY_STEP;
}

// voxel_threshold and voxel_pack of lanes, to the bit.
LW_FN real voxel_thresholds(laneu dither, uint quarter) {
    return to_real(as_lanei_((dither + (laneu)(quarter << 30)) >> (laneu)20)) * 2.44140625e-4f +
           1.220703125e-4f;
}
LW_FN laneu voxel_rounded(real value, real threshold, int most) {
    return as_laneu_(min(to_lanei(value + threshold), (lanei)(most)));
}
LW_FN laneu voxel_packed(real red, real green, real blue, real opacity, float perUnit, laneu dither) {
    const real largest = fmax(fmax(red, green), blue) * perUnit, most = (real)(127.0f);
    const lanei exponent = clamp((as_lanei_(largest * (64.0f / 63.0f)) >> (lanei)(23)) - (lanei)(132),
                                 (lanei)(0), (lanei)(31));
    const real toMantissa = as_real_((lanei)((lanei)(127) - exponent) << (lanei)(23));
    const real r = red * perUnit * toMantissa, g = green * perUnit * toMantissa * 2.0f,
               b = blue * perUnit * toMantissa;
    return as_laneu_(exponent) << (laneu)27 |
           voxel_rounded(opacity * 255.0f, voxel_thresholds(dither, 3u), 255) << (laneu)19 |
           voxel_rounded(fmin(r, most), voxel_thresholds(dither, 0u), 63) << (laneu)13 |
           voxel_rounded(fmin(g, most), voxel_thresholds(dither, 1u), 127) << (laneu)6 |
           voxel_rounded(fmin(b, most), voxel_thresholds(dither, 2u), 63);
}
LW_FN laneu voxel_harmonics(real share, real threshold) {
    const real one = (real)(1.0f);
    return voxel_rounded((clamp(share, -one, one) + 1.0f) * (float)LW_VOXEL_HARMONIC_ZERO, threshold,
                         2 * LW_VOXEL_HARMONIC_ZERO);
}
LW_FN laneu voxel_packed_harmonics(real c0, real x, real y, real z, laneu dither) {
    const real bound = c0 * LW_VOXEL_SQRT3, none = (real)(0.0f);
    const mask some = bound > 0.0f;
    const real inverse = select_(none, 1.0f / select_((real)(1.0f), bound, some), some);
    const real per = select_(none, inverse, inverse < 3e38f);
    const laneu shares = voxel_harmonics(x * per, voxel_thresholds(dither, 0u)) |
                         voxel_harmonics(y * per, voxel_thresholds(dither, 1u)) << (laneu)10 |
                         voxel_harmonics(z * per, voxel_thresholds(dither, 2u)) << (laneu)20;
    return selectu_((laneu)(0u), shares, some);
}
// voxel_dither of lanes.
LW_FN laneu voxel_dithers(lanei x, lanei y, int z, int level, int plane) {
    return as_laneu_(x) * (laneu)3518319155u + as_laneu_(y) * (laneu)2882110345u +
           (laneu)voxel_dither(0, 0, z, level, plane);
}

// Adds four words of SH2: sum[0..3] as voxel_add's, of c0; sum[4 + 3 c + axis] of colour c's c1.
LW_FN void voxel_add_harmonics(laneu word, laneu red, laneu green, laneu blue, int unit, real weight,
                               real* sum) {
    const real step = voxel_step(word, unit, weight);
    const real c0[3] = {voxel_field(word, LW_VOXEL_RED_MASK) * step,
                        voxel_field(word, LW_VOXEL_GREEN_MASK) * step,
                        voxel_field(word, LW_VOXEL_BLUE_MASK) * step};
    const laneu shares[3] = {red, green, blue};
    LW_UNROLL
    for (int c = 0; c < 3; ++c) {
        sum[c] += c0[c];
        sum[4 + 3 * c] = fma_(voxel_field(shares[c], 1023u), c0[c], sum[4 + 3 * c]);
        sum[5 + 3 * c] = fma_(voxel_field(shares[c], 1023u << 10), c0[c], sum[5 + 3 * c]);
        sum[6 + 3 * c] = fma_(voxel_field(shares[c], 1023u << 20), c0[c], sum[6 + 3 * c]);
    }
    sum[3] = fma_(voxel_field(word, LW_VOXEL_OPACITY_MASK), weight, sum[3]);
}
// To premultiplied c0, opacity, and c1.
LW_FN void voxel_scale_harmonics(real* sum) {
    voxel_scale(sum);
    const float colour[3] = {LW_VOXEL_RED_STEP, LW_VOXEL_GREEN_STEP, LW_VOXEL_BLUE_STEP};
    const float field = LW_VOXEL_SQRT3 / (float)LW_VOXEL_HARMONIC_ZERO;
    LW_UNROLL
    for (int c = 0; c < 3; ++c) {
        sum[4 + 3 * c] = fma_(sum[4 + 3 * c], field * colour[c], -LW_VOXEL_SQRT3 * sum[c]);
        sum[5 + 3 * c] =
            fma_(sum[5 + 3 * c], field * colour[c] * 9.765625e-4f, -LW_VOXEL_SQRT3 * sum[c]);
        sum[6 + 3 * c] =
            fma_(sum[6 + 3 * c], field * colour[c] * 9.5367431640625e-7f, -LW_VOXEL_SQRT3 * sum[c]);
    }
}

#endif
