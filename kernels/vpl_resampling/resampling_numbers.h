// Random numbers and luminance as the kernels of `vpl_resampling` share them.
#ifndef LW_RESAMPLING_NUMBERS_H
#define LW_RESAMPLING_NUMBERS_H

#include "shared/wide.h"

// Murmur's finaliser of two numbers: a function of what is drawn for, so no order of execution enters.
LW_FN uint scalar_hash(uint x, uint key) {
    x = x * 0x9e3779b1u + key;
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}
LW_FN laneu lanes_hash(laneu x, uint key) {
    x = x * 0x9e3779b1u + key;
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

// In [0,1).
LW_FN float unit_float(uint x) { return (float)(x >> 8) * (1.0f / 16777216.0f); }
LW_FN real unit_lanes(laneu x) { return to_real(as_lanei_(x >> 8)) * (1.0f / 16777216.0f); }

// Of linear RGB (Rec. 709): what light is weighed by.
LW_FN float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

#endif
