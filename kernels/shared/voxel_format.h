// Words of voxels as cones read them: light and opacity in 32 bits, for few bytes to a trilinear sample.
//
//   31..27 exponent e | 26..19 opacity, 255 = 1 | 18..13 red | 12..6 green | 5..0 blue
//   radiance times opacity ("premultiplied", W/m^2/sr): red, blue = m 2^e u, green = m 2^e u / 2
//
// u is a power of two of the whole grid, LwVoxelState's: 32 exponents lie below the frame's brightest
// voxel. Mantissas have 6 bits (green 7), so that one is off by 1.6 % of its word's brightest colour at
// most; what is cut off is rounded up at a share of the voxels, spread evenly in space, so that sums
// over neighbours keep what was cut. Rounding to the nearest instead makes all voxels of one evenly lit
// wall wrong the same way.
//
// SH2: four words. The first holds c0 as red, green, blue; the others, one for each colour, c1 /
// (sqrt(3) c0) as three numbers of 10 bits, 511 = 0: light without negative directions has none above 1.
// L(d) = Y0 c0 + Y1 (c1 . d), d the way that light leaves, opposite to the ray that meets it; points.h
// has Y0 and Y1.
#ifndef LW_VOXEL_FORMAT_H
#define LW_VOXEL_FORMAT_H

#ifdef __cplusplus
#include <cstring>
#endif

#include "voxel_types.h"

#define LW_VOXEL_RED_MASK 0x0007e000u
#define LW_VOXEL_GREEN_MASK 0x00001fc0u
#define LW_VOXEL_BLUE_MASK 0x0000003fu
#define LW_VOXEL_OPACITY_MASK 0x07f80000u
// What takes a masked field, unshifted, to its number, or to its number over 2^e u.
#define LW_VOXEL_RED_STEP 1.220703125e-4f  // 2^-13
#define LW_VOXEL_GREEN_STEP 7.8125e-3f     // 2^-6 / 2
#define LW_VOXEL_BLUE_STEP 1.0f
#define LW_VOXEL_OPACITY_STEP 7.47979856e-9f  // 2^-19 / 255
#define LW_VOXEL_EXPONENT_SHIFT 4             // from the word's place to a float's
#define LW_VOXEL_EXPONENT_MASK 0x0f800000u    // of the shifted word
// u is one of every so many powers of two, so that it hardly ever changes, and then by far. Smaller: all
// voxels are packed anew more often as lights change. Larger: fewer of the 32 exponents are left below
// the brightest voxel: 24 at least with 8.
#define LW_VOXEL_UNIT_STEP 8
#define LW_VOXEL_LEAST_UNIT (-120)
#define LW_VOXEL_LARGEST_UNIT 64
#define LW_VOXEL_HARMONIC_ZERO 511
#define LW_VOXEL_SQRT3 1.7320508f

// What a grid's words are in, and how many bricks have some.
typedef struct {
    lw_int unit;            // bits of u, which a masked exponent is added to
    lw_float perUnit;       // 1 / u
    lw_int baseBricks;      // slots taken of the finest level
    lw_int mipBricks;       // of the others
    lw_int droppedBricks;   // that found no slot
    lw_int largest;         // bits of the largest premultiplied radiance of a colour
    lw_int changedBricks;   // that this record resolved
    lw_int filteredBricks;  // and filtered, on all levels
} LwVoxelState;
LW_SIZE_CHECK(LwVoxelState, 32);

LW_FN lw_float voxel_float(lw_uint bits) {
#ifdef __cplusplus
    lw_float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
#else
    return as_float(bits);
#endif
}
LW_FN lw_uint voxel_bits(lw_float value) {
#ifdef __cplusplus
    lw_uint bits;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
#else
    return as_uint(value);
#endif
}

// u's exponent for a grid whose largest premultiplied radiance this is (finite, not negative).
LW_FN lw_int voxel_unit_exponent(lw_float largest) {
    // Below 63 * 2^31 u: what is rounded up still fits.
    const lw_int least = (lw_int)(voxel_bits(largest * (64.0f / 63.0f)) >> 23) - 127 - 36;
    const lw_int steps =
        (least + 1024 + LW_VOXEL_UNIT_STEP - 1) / LW_VOXEL_UNIT_STEP - 1024 / LW_VOXEL_UNIT_STEP;
    const lw_int exponent = steps * LW_VOXEL_UNIT_STEP;
    return exponent < LW_VOXEL_LEAST_UNIT     ? LW_VOXEL_LEAST_UNIT
           : exponent > LW_VOXEL_LARGEST_UNIT ? LW_VOXEL_LARGEST_UNIT
                                              : exponent;
}
LW_FN lw_int voxel_unit(lw_int exponent) {
    return (exponent + 127) << 23;
}
LW_FN lw_float voxel_per_unit(lw_int exponent) {
    return voxel_float((lw_uint)(127 - exponent) << 23);
}

// Where a voxel rounds up, of 2^32: points of a lattice whose gaps are even in every box of voxels
// (Roberts 2018, R3: inverse powers of the root of g^4 = g + 1). `plane` and level set the pattern off,
// so that words of one voxel are not rounded alike.
LW_FN lw_uint voxel_dither(lw_int x, lw_int y, lw_int z, lw_int level, lw_int plane) {
    return (lw_uint)x * 3518319155u + (lw_uint)y * 2882110345u + (lw_uint)z * 2360945575u +
           (lw_uint)level * 1640531527u + (lw_uint)plane * 668265263u;
}
// Of the dither's colours, each a quarter on: in (0, 1), of 15 bits so that its sum with a mantissa is
// exact.
LW_FN lw_float voxel_threshold(lw_uint dither, lw_uint quarter) {
    return (lw_float)((dither + (quarter << 30)) >> 20) * 2.44140625e-4f + 1.220703125e-4f;
}

LW_FN lw_uint voxel_round(lw_float value, lw_float threshold, lw_uint most) {
    const lw_uint whole = (lw_uint)(value + threshold);
    return whole < most ? whole : most;
}

// Radiances times opacity, none negative; opacity in [0, 1]. 0 and 1 of opacity come back as they are.
LW_FN lw_uint voxel_pack(lw_float red, lw_float green, lw_float blue, lw_float opacity, lw_float perUnit,
                         lw_uint dither) {
    lw_float largest = red > green ? red : green;
    largest = (largest > blue ? largest : blue) * perUnit;
    lw_int exponent = (lw_int)(voxel_bits(largest * (64.0f / 63.0f)) >> 23) - 127 - 5;
    exponent = exponent < 0 ? 0 : exponent > 31 ? 31 : exponent;
    const lw_float toMantissa = voxel_float((lw_uint)(127 - exponent) << 23);
    // In this order: none of the factors' products leaves float's range before the value comes back into
    // it. Beyond the largest word (a voxel of 2^101 W/m^2/sr) mantissas stay at their most.
    const lw_float most = 127.0f;
    const lw_float r = red * perUnit * toMantissa, g = green * perUnit * toMantissa * 2.0f,
                   b = blue * perUnit * toMantissa;
    return (lw_uint)exponent << 27 |
           voxel_round(opacity * 255.0f, voxel_threshold(dither, 3u), 255u) << 19 |
           voxel_round(r < most ? r : most, voxel_threshold(dither, 0u), 63u) << 13 |
           voxel_round(g < most ? g : most, voxel_threshold(dither, 1u), 127u) << 6 |
           voxel_round(b < most ? b : most, voxel_threshold(dither, 2u), 63u);
}

typedef struct {
    lw_float red, green, blue, opacity;
} LwVoxelValue;
LW_SIZE_CHECK(LwVoxelValue, 16);

LW_FN void voxel_unpack(lw_uint word, lw_int unit, LwVoxelValue* value) {
    const lw_float step =
        voxel_float(((word >> LW_VOXEL_EXPONENT_SHIFT) & LW_VOXEL_EXPONENT_MASK) + (lw_uint)unit);
    value->red = (lw_float)(word & LW_VOXEL_RED_MASK) * LW_VOXEL_RED_STEP * step;
    value->green = (lw_float)(word & LW_VOXEL_GREEN_MASK) * LW_VOXEL_GREEN_STEP * step;
    value->blue = (lw_float)(word & LW_VOXEL_BLUE_MASK) * LW_VOXEL_BLUE_STEP * step;
    value->opacity = (lw_float)((word & LW_VOXEL_OPACITY_MASK) >> 19) / 255.0f;
}

// One colour's c1 over sqrt(3) c0, c0 above 0; 0 of it where c0 is 0.
LW_FN lw_uint voxel_harmonic(lw_float share, lw_float threshold) {
    const lw_float bounded = share < -1.0f ? -1.0f : share > 1.0f ? 1.0f : share;
    return voxel_round((bounded + 1.0f) * (lw_float)LW_VOXEL_HARMONIC_ZERO, threshold,
                       2u * LW_VOXEL_HARMONIC_ZERO);
}
LW_FN lw_uint voxel_pack_harmonics(lw_float c0, lw_float x, lw_float y, lw_float z, lw_uint dither) {
    const lw_float bound = c0 * LW_VOXEL_SQRT3, inverse = bound > 0.0f ? 1.0f / bound : 0.0f;
    // Of c0 too small for an inverse nothing is left of a direction.
    const lw_float per = inverse < 3e38f ? inverse : 0.0f;
    if (!(bound > 0.0f)) return 0u;
    return voxel_harmonic(x * per, voxel_threshold(dither, 0u)) |
           voxel_harmonic(y * per, voxel_threshold(dither, 1u)) << 10 |
           voxel_harmonic(z * per, voxel_threshold(dither, 2u)) << 20;
}
// Axis 0, 1, 2 of c1, of a word and its colour's c0.
LW_FN lw_float voxel_unpack_harmonic(lw_uint word, lw_int axis, lw_float c0) {
    const lw_int field = (lw_int)(word >> (10 * axis) & 1023u) - LW_VOXEL_HARMONIC_ZERO;
    return (lw_float)field * (LW_VOXEL_SQRT3 / (lw_float)LW_VOXEL_HARMONIC_ZERO) * c0;
}

// Planes of words of the finest level and of those above. With `sides` the finest level has, first, six
// sides with an opacity for each axis; what the levels above are filtered from follows, unless it is
// those sides.
LW_FN lw_int voxel_mip_planes(lw_int mode) {
    return mode == 1 ? LW_VOXEL_SIDES : mode == 2 ? LW_VOXEL_HARMONICS : 1;
}
LW_FN lw_int voxel_filtered_plane(lw_int mode, lw_int sides) {
    return sides && mode != 1 ? LW_VOXEL_SIDES : 0;
}
LW_FN lw_int voxel_base_planes(lw_int mode, lw_int sides) {
    if (mode == 1) return sides ? LW_VOXEL_SIDES : 1;
    return voxel_filtered_plane(mode, sides) + voxel_mip_planes(mode);
}

#endif
