// The choice of technique screen_space's samples, level by level, from what a few receivers have been asked (screen_plan.cl).
#ifndef LW_LEVELS
#define LW_LEVELS 4  // 1 .. 6
#endif
#include "shared/portable.h"
#include "shared/screen_plan_types.h"

// A new choice is made for this share of the target and stays while it meets the whole of it and no other would be cheaper by a third:
// light that moves slowly does not switch to and fro.
#define LW_SCREEN_ROOM 0.8f
#define LW_SCREEN_CHEAPER 0.67f
// Of a picture's error, what the receivers see on a coarse level: where surfaces meet, light is nearer than its texels. Measured in drawn corners:
// 0.54 and more. Larger: the target is missed there.
#define LW_SCREEN_SEEN 0.55f
// Of the squared error that independent samples would have, what is left by the even spread of the patterns: measured, see
// docs/techniques/screen_space.md. Larger: more samples than the target needs; smaller: it is missed by noise.
#define LW_SCREEN_NOISE 0.3f

// Relative errors by level and choice: what is lost, as light, and the variance of noise.
typedef struct {
    float lost[LW_LEVELS][LW_SCREEN_CHOICES], noise[LW_LEVELS][LW_SCREEN_CHOICES];
} lw_screen_errors;

// All levels lose light of one sign: what they lose adds up. Their noise does not.
LW_FN float error2_of(const lw_screen_errors* e, const int* choice) {
    float lost = 0.0f, noise = 0.0f;
    for (int k = 0; k < LW_LEVELS; ++k) {
        lost += e->lost[k][choice[k]];
        noise += e->noise[k][choice[k]];
    }
    return lost * lost + noise;
}

LW_FN float samples_of(int choice, int samples) { return choice > LW_SCREEN_HALVINGS ? 0.0f : (float)(samples >> choice); }

LW_FN float cost_of(const int* choice, int samples) {
    float cost = 0.0f, texels = 1.0f;
    for (int k = 0; k < LW_LEVELS; ++k, texels *= 0.25f) cost += samples_of(choice[k], samples) * texels;
    return cost;
}

LW_FN int next_choice(int choice, int halvings) { return choice < halvings ? choice + 1 : LW_SCREEN_CHOICES - 1; }

// From the most on, again and again the step that saves most texels' samples for the squared error that it adds, up to the target. The row of
// steps is the same for every target, so that a larger one never takes more.
LW_FN void choose(const lw_screen_errors* e, int samples, int halvings, float target2, int* choice) {
    for (int k = 0; k < LW_LEVELS; ++k) choice[k] = 0;
    for (int round = 0; round < LW_LEVELS * LW_SCREEN_CHOICES; ++round) {
        const float now = error2_of(e, choice);
        float best = -1.0f, bestError = 0.0f, texels = 1.0f;
        int step = -1;
        for (int k = 0; k < LW_LEVELS; ++k, texels *= 0.25f) {
            const int before = choice[k];
            // The first level's light is that of few pixels, which the receivers may all miss: it is never left out.
            if (before == LW_SCREEN_CHOICES - 1 || (k == 0 && before == halvings)) continue;
            choice[k] = next_choice(before, halvings);
            const float saved = (samples_of(before, samples) - samples_of(choice[k], samples)) * texels;
            const float after = error2_of(e, choice), gain = saved / (fmax(after - now, 0.0f) + 1e-12f);
            choice[k] = before;
            if (gain > best) {
                best = gain;
                bestError = after;
                step = k;
            }
        }
        if (step < 0 || !(bestError <= target2)) return;
        choice[step] = next_choice(choice[step], halvings);
    }
}

LW_FN float probed_at(__global const float* probed, int k, int plane, int r) {
    return probed[(k * LW_PROBED_PLANES + plane) * LW_PROBES + r];
}

// Means over the receivers, and roots of mean squares, relative to the mean of all light.
LW_FN void errors_of_level(lw_screen_errors* e, __global const float* probed, int k, LwScreenRings rings, int samples, int patterns,
                           int whole, float perLight) {
    float lost2[LW_SCREEN_CHOICES] = {0.0f}, share2 = 0.0f, spread = 0.0f;
    for (int r = 0; r < LW_PROBES; ++r) {
        const float light = probed_at(probed, k, LW_PROBED_LIGHT, r) * perLight, share = probed_at(probed, k, LW_PROBED_SHARE, r);
        for (int c = 0; c < LW_SCREEN_HALVINGS; ++c) {
            const float loss = probed_at(probed, k, LW_PROBED_LOSS + c, r) * perLight;
            lost2[c + 1] += loss * loss;
        }
        lost2[LW_SCREEN_CHOICES - 1] += light * light;
        share2 += share * share;
        spread += fmax(rings.area[k] * probed_at(probed, k, LW_PROBED_SQUARES, r) * perLight * perLight - light * light, 0.0f);
    }
    const float each = 1.0f / LW_PROBES;
    for (int c = 0; c < LW_SCREEN_CHOICES; ++c) {
        e->lost[k][c] = sqrt(lost2[c] * each);
        const int count = c > LW_SCREEN_HALVINGS ? 0 : samples >> c;
        // Rings that are taken whole have no noise; the most has no error, being what the others are held against.
        e->noise[k][c] = c == 0 || count == 0 || (whole & count) ? 0.0f : LW_SCREEN_NOISE * spread * each / (float)(count * patterns);
    }
    // Without a level its share of the hemisphere is gone, too, of which validity is made.
    e->lost[k][LW_SCREEN_CHOICES - 1] = fmax(e->lost[k][LW_SCREEN_CHOICES - 1], sqrt(share2 * each));
}

// One work-item. samples: the most; halvings: of them that there are; patterns: texels with patterns of their own, whose mean the filter
// takes; wholeDisc, wholeRing: sum of the numbers of samples with which the first level's disc and the others' rings are taken whole.
__kernel void screen_plan_choose(__global const float* probed, LwScreenRings rings, int samples, int halvings, int patterns, int wholeDisc,
                                 int wholeRing, float target, int restart, __global int* plan) {
    if (get_global_id(0) != 0) return;
    float light = 0.0f;
    for (int k = 0; k < LW_LEVELS; ++k)
        for (int r = 0; r < LW_PROBES; ++r) light += probed_at(probed, k, LW_PROBED_LIGHT, r);
    const float perLight = light > 0.0f ? (float)LW_PROBES / light : 0.0f;
    lw_screen_errors errors;
    for (int k = 0; k < LW_LEVELS; ++k) errors_of_level(&errors, probed, k, rings, samples, patterns, k == 0 ? wholeDisc : wholeRing, perLight);
    int chosen[LW_LEVELS], before[LW_LEVELS];
    target *= LW_SCREEN_SEEN;
    const float room = LW_SCREEN_ROOM * target;
    choose(&errors, samples, halvings, room * room, chosen);
    if (!restart) {
        for (int k = 0; k < LW_LEVELS; ++k) before[k] = plan[LW_SCREEN_PLAN_CHOSEN + k];
        const int stays = error2_of(&errors, before) <= target * target && cost_of(chosen, samples) >= LW_SCREEN_CHEAPER * cost_of(before, samples);
        for (int k = 0; k < LW_LEVELS && stays; ++k) chosen[k] = before[k];
    }
    int used = 0, most = 1;
    for (int k = 0; k < LW_LEVELS; ++k) {
        plan[LW_SCREEN_PLAN_SAMPLES + k] = (int)samples_of(chosen[k], samples);
        plan[LW_SCREEN_PLAN_CHOSEN + k] = chosen[k];
        used += chosen[k] < LW_SCREEN_CHOICES - 1;
        most = most && chosen[k] == 0;
    }
    plan[LW_SCREEN_PLAN_FIRST] = plan[LW_SCREEN_PLAN_SAMPLES];
    plan[LW_SCREEN_PLAN_USED] = used;
    plan[LW_SCREEN_PLAN_WHY_SAMPLES] = most ? LW_SCREEN_WHY_MOST : light > 0.0f ? LW_SCREEN_WHY_TARGET : LW_SCREEN_WHY_DARK;
    plan[LW_SCREEN_PLAN_WHY_LEVELS] = used == LW_LEVELS ? LW_SCREEN_WHY_MOST : light > 0.0f ? LW_SCREEN_WHY_TARGET : LW_SCREEN_WHY_DARK;
}
