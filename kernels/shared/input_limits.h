// How large the numbers of a host's input may be: within these limits no sum, square or quotient of the
// kernels leaves float's range, so that no input can put a NaN into a picture.
#ifndef LW_INPUT_LIMITS_H
#define LW_INPUT_LIMITS_H

// Distance of a position from the origin, in units of length. The gather takes the fourth power of the distance
// between two positions: (2e9)^4 = 1.6e37; from 4e9 on it would be infinite, and the light 0 or no number.
#define LW_LARGEST_DISTANCE 1e9f

// Reflected flux of a texel above which it is refused as garbage. Sums over the most texels that fit stay
// finite (2e8 * 1e30 < 3e38), and no lamp comes near it in any unit of length.
#define LW_LARGEST_FLUX 1e30f

// What a pixel's irradiance is brought down to, and counted: a strong VPL that lies in the pixel (of area 0) would
// exceed float's range, and infinity times a filter's weight 0 is no number. A filter adds up to 64 of them.
#define LW_LARGEST_IRRADIANCE 1e36f

// Radiance of a surface above which it is refused as garbage: the sun's disc has 2e7 W/m^2/sr, and sums of so much over all of a
// scene's area stay finite.
#define LW_LARGEST_EMISSION 1e20f

#endif
