// The choice of technique screen_space's start and samples, level by level, from what other choices would miss (screen_errors.cl).
#ifndef LW_LEVELS
#define LW_LEVELS 4  // 1 .. 6
#endif
#include "shared/portable.h"
#include "shared/screen_plan_types.h"

// A new choice is made for this share of the target and stays while it meets the whole of it and no other would be cheaper by a third. Nor is
// there a cheaper one before all receivers have been asked since the last: light that moves is known of some, and not yet of others. So
// light that moves slowly does not switch to and fro.
#define LW_SCREEN_ROOM 0.8f
#define LW_SCREEN_CHEAPER 0.67f
// Of a picture's error, what the receivers see on a coarse level: where surfaces meet, light is nearer than its texels. Measured in drawn corners:
// 0.54 and more. Larger: the target is missed there.
#define LW_SCREEN_SEEN 0.55f
// Squared error of texels without a coarser one of their surface, by that of the light: they take light of surfaces that face alike. Measured,
// see docs/techniques/screen_space.md. Smaller: a coarser start where its texels show.
#define LW_SCREEN_DETAIL 5.0f
// What a texel of a level takes beside its samples, in samples: being dealt, filtered and added; and only added, where it has none. Measured
// by figure 7 of docs/techniques/screen_space_figures.md.
#define LW_SCREEN_TEXEL 22.0f
#define LW_SCREEN_ADDED 8.0f
// Largest of the reported thousandths.
#define LW_SCREEN_LARGEST_PERMILLE 1e6f

// Level `start` takes the whole disc, and those before it have no samples.
typedef struct { int start, choice[LW_LEVELS]; } lw_choice;

// All levels lose light of one sign: what they lose adds up. Their noise does not.
LW_FN float lost_of(__global const float* errors, const lw_choice* plan) {
    float lost = 0.0f;
    for (int k = plan->start; k < LW_LEVELS; ++k) lost += errors[LW_ERROR_AT(plan->start, k, LW_ERROR_LOST) + plan->choice[k]];
    return lost;
}

LW_FN float noise2_of(__global const float* errors, const lw_choice* plan) {
    float noise = 0.0f;
    for (int k = plan->start; k < LW_LEVELS; ++k) noise += errors[LW_ERROR_AT(plan->start, k, LW_ERROR_NOISE) + plan->choice[k]];
    return noise;
}

// detail2: by start, the squared error of texels without a coarser one.
LW_FN float error2_of(__global const float* errors, const float* detail2, const lw_choice* plan) {
    return squared(lost_of(errors, plan)) + noise2_of(errors, plan) + detail2[plan->start];
}

LW_FN float samples_of(int choice, int samples) { return choice > LW_SCREEN_HALVINGS ? 0.0f : (float)(samples >> choice); }

LW_FN float cost_of_texel(int choice, int samples) {
    return choice > LW_SCREEN_HALVINGS ? LW_SCREEN_ADDED : samples_of(choice, samples) + LW_SCREEN_TEXEL;
}

LW_FN float cost_of(const lw_choice* plan, int samples) {
    float cost = 0.0f, texels = 1.0f;
    for (int k = 0; k < LW_LEVELS; ++k, texels *= 0.25f) cost += cost_of_texel(plan->choice[k], samples) * texels;
    return cost;
}

LW_FN int next_choice(int choice, int halvings) { return choice < halvings ? choice + 1 : LW_SCREEN_CHOICES - 1; }

// From the most on, again and again the step that saves most texels' samples for the squared error that it adds, up to the target. The row of
// steps is the same for every target, so that a larger one never takes more.
LW_FN void choose_samples(__global const float* errors, const float* detail2, int samples, int halvings, float target2, lw_choice* plan) {
    const int start = plan->start;
    for (int k = 0; k < LW_LEVELS; ++k) plan->choice[k] = k < start ? LW_SCREEN_CHOICES - 1 : 0;
    for (int round = 0; round < LW_LEVELS * LW_SCREEN_CHOICES; ++round) {
        const float now = error2_of(errors, detail2, plan);
        float best = -1.0f, bestError = 0.0f, texels = 1.0f;
        int step = -1;
        for (int k = start; k < LW_LEVELS; ++k, texels *= 0.25f) {
            const int before = plan->choice[k];
            // The first level's light is that of few pixels, which the receivers may all miss: it is never left out.
            if (before == LW_SCREEN_CHOICES - 1 || (k == start && before == halvings)) continue;
            plan->choice[k] = next_choice(before, halvings);
            const float saved = (cost_of_texel(before, samples) - cost_of_texel(plan->choice[k], samples)) * texels;
            const float after = error2_of(errors, detail2, plan), gain = saved / (fmax(after - now, 0.0f) + 1e-12f);
            plan->choice[k] = before;
            if (gain > best) {
                best = gain;
                bestError = after;
                step = k;
            }
        }
        if (step < 0 || !(bestError <= target2)) return;
        plan->choice[step] = next_choice(plan->choice[step], halvings);
    }
}

// Of the starts that meet the target the cheapest; the finest is always one.
LW_FN void choose(__global const float* errors, const float* detail2, int samples, int halvings, int starts, float target2, lw_choice* plan) {
    plan->start = 0;
    choose_samples(errors, detail2, samples, halvings, target2, plan);
    for (int start = 1; start < starts; ++start) {
        lw_choice other;
        other.start = start;
        // Two steps have the samples stand for 16 times as much: the receivers are not asked for more than twice that.
        choose_samples(errors, detail2, samples, start == 1 ? halvings : min(halvings, 1), target2, &other);
        if (error2_of(errors, detail2, &other) <= target2 && cost_of(&other, samples) < cost_of(plan, samples)) *plan = other;
    }
}

// Nothing is missed of a picture without light.
LW_FN void detail_errors(__global const int* detail, int items, int isLit, float* detail2) {
    int surfaces = 0, lost[LW_SCREEN_STARTS] = {0};
    for (int i = 0; i < items; ++i) {
        surfaces += detail[i] & 0xff;
        for (int start = 1; start < LW_SCREEN_STARTS; ++start) lost[start] += (detail[i] >> (8 * start)) & 0xff;
    }
    // Of the picture, not of what the receivers see of it.
    for (int start = 0; start < LW_SCREEN_STARTS; ++start)
        detail2[start] = surfaces > 0 && isLit ? squared(LW_SCREEN_SEEN) * LW_SCREEN_DETAIL * (float)lost[start] / (float)surfaces : 0.0f;
}

LW_FN int permille_of(float error) { return (int)(fmin(1000.0f / LW_SCREEN_SEEN * error, LW_SCREEN_LARGEST_PERMILLE) + 0.5f); }

LW_FN void write_plan(__global int* plan, const lw_choice* chosen, int samples, int start, int isLit) {
    const int fewer = isLit ? LW_SCREEN_WHY_TARGET : LW_SCREEN_WHY_DARK;
    int used = 0, most = 1;
    for (int k = 0; k < LW_LEVELS; ++k) {
        plan[LW_SCREEN_PLAN_SAMPLES + k] = (int)samples_of(chosen->choice[k], samples);
        plan[LW_SCREEN_PLAN_CHOSEN + k] = chosen->choice[k];
        used += chosen->choice[k] < LW_SCREEN_CHOICES - 1;
        most = most && (k < chosen->start || chosen->choice[k] == 0);
    }
    plan[LW_SCREEN_PLAN_START] = chosen->start;
    plan[LW_SCREEN_PLAN_FIRST] = plan[LW_SCREEN_PLAN_SAMPLES + chosen->start];
    plan[LW_SCREEN_PLAN_START_USED] = start + chosen->start;
    plan[LW_SCREEN_PLAN_USED] = used;
    plan[LW_SCREEN_PLAN_WHY_START] = chosen->start == 0 ? LW_SCREEN_WHY_MOST : fewer;
    plan[LW_SCREEN_PLAN_WHY_SAMPLES] = most ? LW_SCREEN_WHY_MOST : fewer;
    plan[LW_SCREEN_PLAN_WHY_LEVELS] = used + chosen->start == LW_LEVELS ? LW_SCREEN_WHY_MOST : fewer;
}

// One work-item. samples: the most; halvings: of them that there are; starts: that there are, the first being `start`; detailItems: of
// screen_plan_detail.
__kernel void screen_plan_choose(__global const float* errors, __global const int* detail, int detailItems, int samples, int halvings,
                                 int starts, int start, float target, int restart, __global int* plan) {
    if (get_global_id(0) != 0) return;
    const int isLit = errors[LW_ERROR_LIGHT] > 0.0f;
    float detail2[LW_SCREEN_STARTS];
    detail_errors(detail, detailItems, isLit, detail2);
    target *= LW_SCREEN_SEEN;
    lw_choice chosen, before;
    choose(errors, detail2, samples, halvings, starts, squared(LW_SCREEN_ROOM * target), &chosen);
    int age = 0;
    if (!restart) {
        age = min(plan[LW_SCREEN_PLAN_AGE] + 1, LW_PROBE_TURNS);
        before.start = plan[LW_SCREEN_PLAN_START];
        for (int k = 0; k < LW_LEVELS; ++k) before.choice[k] = plan[LW_SCREEN_PLAN_CHOSEN + k];
        const int cheaper = age == LW_PROBE_TURNS && cost_of(&chosen, samples) < LW_SCREEN_CHEAPER * cost_of(&before, samples);
        if (error2_of(errors, detail2, &before) <= squared(target) && !cheaper)
            chosen = before;
        else
            age = 0;
    }
    plan[LW_SCREEN_PLAN_AGE] = age;
    plan[LW_SCREEN_PLAN_LOST] = permille_of(lost_of(errors, &chosen));
    plan[LW_SCREEN_PLAN_NOISE] = permille_of(sqrt(noise2_of(errors, &chosen)));
    plan[LW_SCREEN_PLAN_DETAIL] = permille_of(sqrt(detail2[chosen.start]));
    write_plan(plan, &chosen, samples, start, isLit);
}
