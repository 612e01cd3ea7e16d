// Light that may not arrive: how much of it counts.
#ifndef LW_DOUBTFUL_LIGHT_H
#define LW_DOUBTFUL_LIGHT_H

#include "wide.h"

// The share of `light` that counts when `doubt` of it is doubtful (sums over channels, 0 or more): sure light S bears doubtful light D out
// by S^2 / (S^2 + D^2), and what is left of S + D is S + D S^2 / (S^2 + D^2). Where little is sure, next to nothing doubtful counts;
// where an edge's light is a small part of all, next to nothing is lost. Of light that arrives or does not with even odds, the share
// S^2 / (S^2 + (S + D)^2) has the least squared error relative to what arrives: where D is large it is this one. Where D is small this
// one is larger, as the texel that was looked up is right more often than not. Measured in docs/techniques/ssvp_visibility.md.
LW_FN real borne_out(real light, real doubt) {
    const real d = select_((real)0.0f, fmin(doubt / light, (real)1.0f), light > 0.0f), s = 1.0f - d;
    return 1.0f - d * d * d / fma_(s, s, d * d);
}

#endif
