// What host and kernels of pass `screen_plan` share: a frame's plan, in which the gather reads how many samples each level takes.
#ifndef LW_SCREEN_PLAN_TYPES_H
#define LW_SCREEN_PLAN_TYPES_H

#include "portable.h"

#define LW_SCREEN_PLAN_LEVELS 6  // the most that there are

// A level's samples are the most there may be, halved so often; or none.
#define LW_SCREEN_HALVINGS 3
#define LW_SCREEN_CHOICES (LW_SCREEN_HALVINGS + 2)

// Integers of the plan: samples of each level; samples of the first level and levels used, for the report; why; and the
// choice of each level, which the next frame starts from.
#define LW_SCREEN_PLAN_SAMPLES 0
#define LW_SCREEN_PLAN_FIRST 6
#define LW_SCREEN_PLAN_USED 7
#define LW_SCREEN_PLAN_WHY_SAMPLES 8
#define LW_SCREEN_PLAN_WHY_LEVELS 9
#define LW_SCREEN_PLAN_CHOSEN 10
#define LW_SCREEN_PLAN_WORDS 16

#define LW_SCREEN_WHY_MOST 0    // the target would take more
#define LW_SCREEN_WHY_TARGET 1  // the target is met by these
#define LW_SCREEN_WHY_DARK 2    // nothing is lit

// Receivers that are asked, evenly over the picture; columns a multiple of every LW_WIDTH.
#define LW_PROBE_COLUMNS 32
#define LW_PROBE_ROWS 16
#define LW_PROBES (LW_PROBE_COLUMNS * LW_PROBE_ROWS)

// What a level brings to a receiver, each a plane of LW_PROBES floats: light with the most samples, what each halving takes of it
// by bounding its samples more, the sum of squares of what its texels send, and the share of the hemisphere that they fill. Light is
// in units of the picture's brightest texel: squares of watts would leave float's range.
#define LW_PROBED_LIGHT 0
#define LW_PROBED_LOSS 1
#define LW_PROBED_SQUARES (1 + LW_SCREEN_HALVINGS)
#define LW_PROBED_SHARE (2 + LW_SCREEN_HALVINGS)
#define LW_PROBED_PLANES (3 + LW_SCREEN_HALVINGS)
#define LW_PROBED_FLOATS (LW_SCREEN_PLAN_LEVELS * LW_PROBED_PLANES * LW_PROBES)

#define LW_PROBE_MOST_ROWS 64  // of texels that are asked; more are stepped over

// Rings of the levels in texels of the level that is asked: outer edge squared, area, and area by the area of one of the level's
// own texels.
typedef struct LwScreenRings {
    lw_float outer2[LW_SCREEN_PLAN_LEVELS], area[LW_SCREEN_PLAN_LEVELS], texels[LW_SCREEN_PLAN_LEVELS];
} LwScreenRings;
LW_SIZE_CHECK(LwScreenRings, 72);

#endif
