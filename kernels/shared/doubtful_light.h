// Light that may not arrive: how much of it counts.
#ifndef LW_DOUBTFUL_LIGHT_H
#define LW_DOUBTFUL_LIGHT_H

#include "wide.h"

// Doubtful light this many times as strong as what is sure counts by half. Raised: bright fringes where little else arrives; lowered:
// bright rooms darken along every edge. Measured in docs/techniques/ssvp_visibility.md.
#define LW_DOUBT_BORNE 2.0f

// The share of `light` that counts when `doubt` of it is doubtful (sums over channels, 0 or more): sure light S bears doubtful light D out by
//   w = 1 / (1 + (D / 2S)^2), and S + w D is left of S + D.
// 2S at most, where D is 2S. Where little is sure, next to nothing doubtful counts; where an edge's light is a small part of all, next to
// nothing is lost. Of light that arrives with odds p : 1, the share p S^2 / (p S^2 + (S + D)^2) has the least squared error relative to
// what arrives: with odds of 4 : 1 this one where D is large. Where D is small ours is larger, 1 for 4/5, so that nothing is lost of
// light without edges.
LW_FN real borne_out(real light, real doubt) {
    const real d = select_((real)0.0f, fmin(doubt / light, (real)1.0f), and_(light > 0.0f, light < INFINITY)), s = LW_DOUBT_BORNE * (1.0f - d);
    return 1.0f - d * d * d / fma_(s, s, d * d);
}

// Light of bounces without shadows, this many times as strong as the shadowed light beside it, counts by half. Raised: light of surfaces behind
// walls; lowered: what comes round corners, where shadowed bounces bring little, is lost, most of all with few clusters.
#define LW_UNSHADOWED_BORNE 16.0f
// As much of it counts in any case: places that only later bounces reach have no shadowed light at all. A share f leaves f^2 of the squared error
// of light behind walls and (1 - f)^2 of what black is off by. Raised: the former; lowered: such places darken, to black with 0.
#define LW_UNSHADOWED_LEAST 0.25f

// The share of light of bounces without shadows that counts where `shadowed` of `all` light is shadowed (sums over channels, 0 or more): of
// U = all - shadowed as much as the shadowed light S bears out, w = max(1 / (1 + (U / kS)^2), f). Where a sum is beyond all floats, none of
// U counts.
LW_FN real unshadowed_share(real shadowed, real all) {
    const mask isLit = and_(all > 0.0f, all < INFINITY);
    const real part = select_((real)0.0f, fmin(shadowed / all, (real)1.0f), isLit), s = LW_UNSHADOWED_BORNE * part, u = 1.0f - part;
    return select_((real)0.0f, fmax(s * s / fma_(s, s, u * u), (real)LW_UNSHADOWED_LEAST), isLit);
}

// What is left of a channel. (Without a share the difference may be one of infinities.)
LW_FN real borne_part(real shadowed, real all, real share) { return select_(shadowed, fma_(share, all - shadowed, shadowed), share > 0.0f); }

#endif
