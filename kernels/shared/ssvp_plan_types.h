// What host and kernels of pass `ssvp_plan` share: the words of the plan, in which they read what a frame needs.
#ifndef LW_SSVP_PLAN_TYPES_H
#define LW_SSVP_PLAN_TYPES_H

// Integers: how many are used, and why (one of LW_WHY_*).
#define LW_PLAN_VPLS 0
#define LW_PLAN_CLUSTERS 1
#define LW_PLAN_BOUNCES 2
#define LW_PLAN_WHY_VPLS 3
#define LW_PLAN_WHY_CLUSTERS 4
#define LW_PLAN_WHY_BOUNCES 5
// Float: flux of the bounces so far that arrives on surfaces, in W, mean of the channels.
#define LW_PLAN_FLUX 6
// 1 where the bounce after the first, the second, the third is used.
#define LW_PLAN_USES 7
#define LW_PLAN_WORDS 10

#define LW_WHY_FIRST 0   // a first frame, or the first after a cut: the most
#define LW_WHY_MOST 1    // the target would take more
#define LW_WHY_TARGET 2  // the target is met by these
#define LW_WHY_LIGHT 3   // so few texels carry the light
#define LW_WHY_FIXED 4   // the other parameters leave no choice: the most

// Words of the plan of a stage's clusters: those not to be used, a bit each; 64 of them.
#define LW_DEAD_WORDS 2

#endif
