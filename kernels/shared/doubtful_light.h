// Light that may not arrive: how much of it counts.
#ifndef LW_DOUBTFUL_LIGHT_H
#define LW_DOUBTFUL_LIGHT_H

#include "wide.h"

// Doubtful light this many times as strong as what is sure counts by half. Raised: bright fringes where little else arrives; lowered:
// bright rooms darken along every edge. Measured in docs/techniques/ssvp_visibility.md.
#define LW_DOUBT_BORNE 2.0f
// The same of light that nobody looked after, of bounces without shadows. Raised: light of surfaces behind walls; lowered: light that comes
// round corners, where shadowed bounces bring little, is lost, most of all with few clusters.
#define LW_UNSHADOWED_BORNE 16.0f

// The share of `light` that counts when `doubt` of it is doubtful (sums over channels, 0 or more): sure light S bears doubtful light D out by
//   w = 1 / (1 + (D / kS)^2), and S + w D is left of S + D.
// w D is kS/2 at most, where D is kS. Where little is sure, next to nothing doubtful counts; where an edge's light is a small part of all, next to
// nothing is lost. Of light that arrives with odds p : 1, the share p S^2 / (p S^2 + (S + D)^2) has the least squared error relative to
// what arrives: with odds of 4 : 1 this one where D is large. Where D is small ours is larger, 1 for 4/5, so that nothing is lost of
// light without edges.
LW_FN real borne_out(real light, real doubt, float k) {
    const real d = select_((real)0.0f, fmin(doubt / light, (real)1.0f), and_(light > 0.0f, light < INFINITY)), s = k * (1.0f - d);
    return 1.0f - d * d * d / fma_(s, s, d * d);
}

#endif
