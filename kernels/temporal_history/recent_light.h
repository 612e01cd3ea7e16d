// What the last frames' light says of a history: how far that may lie off, and how much of it is to be forgotten.
// temporal_history.cl derives m, s and b.
#ifndef LW_RECENT_LIGHT_H
#define LW_RECENT_LIGHT_H

#include "shared/wide.h"

#define LW_UNROLL _Pragma("unroll")

// Frames after which s of a new surface is known well enough to clip by. What was forgotten later leaves s known: three frames
// without bounds would drag light that goes on changing.
#define LW_LEARNING 4.0f
// Frames that m is a mean over, at most. Larger: (1 - 1/3)^8 = 4 % of a change are left in m, and so in the history, after 8
// frames; 10 % would be with 4. Smaller: m follows noise, and the history with it.
#define LW_RECENT_FRAMES 3.0f
// Of a change by as much in every frame, m lacks two frames' and Y - m_before shows three.
#define LW_TREND_AHEAD (2.0f / 3.0f)
// Frames that b is a mean over. Larger: b lags where light goes up and then down. Smaller: it follows noise.
#define LW_TREND_FRAMES 4.0f
// b, in s * light, from which the mean forgets for the light's being in motion, all of it at half as much again. Larger: lag where
// light changes steadily. Smaller: noise of more than half of the light, whose b comes as far by chance, is averaged less.
#define LW_TREND_TELLS 1.0f
// Deviation of m + 2/3 b from the light's mean over that of Y from m + b, of independent noise, rounded up.
#define LW_RECENT_REACH 0.5f
// Slope with which the mean forgets: all at half of the distance cut off (light twice as far from its past as the bounds
// reach), nothing up to a quarter. Larger: lag, where light changes by hardly more than its noise.
#define LW_FORGETTING 4.0f
// Steps of s in a frame. Larger: s trembles, and takes a row of jumps for noise. Smaller: it learns late that a technique's
// noise has changed. Up is two steps down, taken back: s comes again to where it was, so that light which repeats itself gives
// pictures that do; by sixteenths up and down it wandered, and the mean with it, by some 5e-4 over 500 frames.
#define LW_SPREAD_UP (1.0625f * 1.0625f)
#define LW_SPREAD_DOWN (1.0f / 1.0625f)
// s of a new surface.
#define LW_FIRST_SPREAD 0.1f
// Least s: a picture without noise learns nothing of noise to come. Larger: that much of a light that has gone may stay.
#define LW_LEAST_SPREAD 0.01f
// Light of more is no number: sums and bounds of it would overflow, and what they leave behind is NaN.
#define LW_MOST_LIGHT 1e30f

// Share of the past to keep, when it lies `distance` away and may lie `reach` away.
LW_FN real kept(real distance, real reach) {
    const real cut = 1.0f - reach / fmax(distance, (real)1e-37f);
    return clamp(LW_FORGETTING * (0.5f - cut), (real)0.0f, (real)1.0f);
}

// The `count` values of one kind: `past` is brought between its bounds, m, s and b go on by a frame. Returns the
// share of the mean's frames to keep.
LW_FN real follow(real* past, const real* own, const int count, real age, real gamma, mask trusted, real* m, real* s, real* b) {
    real before = (real)0.0f, now = (real)0.0f;
    LW_UNROLL for (int c = 0; c < count; ++c) {
        before += past[c];
        now += own[c];
    }
    const real spread = gamma * *s;
    real share = select_((real)1.0f, kept(fabs(now - before), spread * (0.5f * (now + before))), trusted);
    const real away = now - *m, light = 0.5f * (now + *m);
    const real recent = fma_(away, 1.0f / fmin(age + 1.0f, (real)LW_RECENT_FRAMES), *m);
    const real trend = fma_(away - *b, (real)(1.0f / LW_TREND_FRAMES), *b);
    const real centre = fmax(fma_((real)LW_TREND_AHEAD, trend, recent), (real)0.0f);
    const real reach = LW_RECENT_REACH * spread * (0.5f * (recent + before));
    share = fmin(share, select_((real)1.0f, kept(fabs(centre - before), reach), trusted));
    const real aim = select_(before, clamp(before, centre - reach, centre + reach), trusted);
    // Less light: the same colour. More: of the colour that comes, none of a dark frame.
    const real less = fmax(aim, (real)0.0f) / fmax(before, (real)1e-37f), more = aim - before, whole = 1.0f / fmax(now, (real)1e-37f);
    LW_UNROLL for (int c = 0; c < count; ++c)
        past[c] = select_(fma_(more, clamp(own[c] * whole, (real)0.0f, (real)1.0f), past[c]), past[c] * less, aim < before);
    const real leap = away - *b;
    const mask back = or_(and_(leap > 0.0f, *b < 0.0f), and_(leap < 0.0f, *b > 0.0f));
    const real told = fabs(trend) / fmax(*s * light, (real)1e-37f);
    const real steady = select_((real)1.0f, clamp(3.0f - told * (2.0f / LW_TREND_TELLS), (real)0.0f, (real)1.0f), trusted);
    const real step = select_((real)LW_SPREAD_DOWN, select_((real)1.0f, (real)LW_SPREAD_UP, back), fabs(leap) > *s * light);
    *m = fma_(recent - now, share, now);
    *b = trend * share;
    *s = clamp(*s * step, (real)LW_LEAST_SPREAD, (real)1.0f);
    return fmin(share, steady);  // m and b know of the motion
}

#endif
