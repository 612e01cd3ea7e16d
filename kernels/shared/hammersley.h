// Points of a Hammersley set, (k + 1/2) / N and the radical inverse of k, and their rotation.
#ifndef LW_HAMMERSLEY_H
#define LW_HAMMERSLEY_H

#include "portable.h"

// The radical inverse of k in base 2, in [0,1): 24 bits, so that it never rounds up to 1.
LW_FN float radical_inverse(uint k) {
    k = (k << 16) | (k >> 16);
    k = ((k & 0x00ff00ffu) << 8) | ((k & 0xff00ff00u) >> 8);
    k = ((k & 0x0f0f0f0fu) << 4) | ((k & 0xf0f0f0f0u) >> 4);
    k = ((k & 0x33333333u) << 2) | ((k & 0xccccccccu) >> 2);
    // The last swap in floats, exact as the halves share no bit: written as the others, LLVM recognises a
    // bit reversal and emits an intrinsic that Oclgrind lacks.
    const float odd = (float)((k & 0x55555555u) >> 7), even = (float)((k & 0xaaaaaaaau) >> 9);
    return (odd + even) * (1.0f / 16777216.0f);
}

LW_FN float wrap_unit(float u) {
    u -= u >= 1.0f ? 1.0f : 0.0f;
    return fmin(u, 0.99999994f);
}

#endif
