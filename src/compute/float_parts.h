// Doubles as floats that add up to them: kernels have no doubles.
#pragma once

namespace lightwell {

// Rounded to a float, for what that leaves of `x` to be taken. Volatile: of loops over arrays GCC 12.2 at -O3 makes vectors, and leaves
// the rounding to a float and back out of x - double(float(x)): nothing is left then.
inline float roundedToFloat(double x) {
    const volatile float rounded = float(x);
    return rounded;
}
// What the nearest float leaves of `x`, without an error.
inline double restOf(double x) { return x - double(roundedToFloat(x)); }

}  // namespace lightwell
