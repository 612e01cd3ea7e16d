// What host and kernels of pass `screen_plan` share: a frame's plan, in which the gather reads where it starts and how many
// samples each level takes.
#ifndef LW_SCREEN_PLAN_TYPES_H
#define LW_SCREEN_PLAN_TYPES_H

#include "portable.h"

#define LW_SCREEN_PLAN_LEVELS 6  // the most that there are

// A level's samples are the most there may be, halved so often; or none.
#define LW_SCREEN_HALVINGS 3
#define LW_SCREEN_CHOICES (LW_SCREEN_HALVINGS + 2)
#define LW_SCREEN_STARTS 3  // the first level's resolution, half and a quarter of it; no coarser than a quarter of the picture's

// Integers of the plan: samples of each level; samples of the first level and levels used, for the report; why; the
// choice of each level, which the next frame starts from; what the choice is taken to cost, in thousandths of the picture's
// light: lost, noise, and texels that a coarser start misses; how many levels are left out before the one that takes the
// whole disc, and LWStart of that, and why; and since how many frames it has been so.
#define LW_SCREEN_PLAN_SAMPLES 0
#define LW_SCREEN_PLAN_FIRST 6
#define LW_SCREEN_PLAN_USED 7
#define LW_SCREEN_PLAN_WHY_SAMPLES 8
#define LW_SCREEN_PLAN_WHY_LEVELS 9
#define LW_SCREEN_PLAN_CHOSEN 10
#define LW_SCREEN_PLAN_LOST 16
#define LW_SCREEN_PLAN_NOISE 17
#define LW_SCREEN_PLAN_DETAIL 18
#define LW_SCREEN_PLAN_START 19
#define LW_SCREEN_PLAN_START_USED 20
#define LW_SCREEN_PLAN_WHY_START 21
#define LW_SCREEN_PLAN_AGE 22
#define LW_SCREEN_PLAN_WORDS 23

#define LW_SCREEN_WHY_MOST 0    // the target would take more
#define LW_SCREEN_WHY_TARGET 1  // the target is met by these
#define LW_SCREEN_WHY_DARK 2    // nothing is lit

// Receivers that are asked, evenly over the picture; columns a multiple of every LW_WIDTH.
#define LW_PROBE_COLUMNS 32
#define LW_PROBE_ROWS 16
#define LW_PROBES (LW_PROBE_COLUMNS * LW_PROBE_ROWS)

// Each frame asks every so many rows of receivers and has the others' answers of the frames before; the first frame asks
// all. More: the passes cost less, and a choice takes as many frames to hear of light that came everywhere at once.
#define LW_PROBE_TURNS 16

// Halvings that receivers are asked for. A start one step coarser has samples stand for four times as much, beside its own halvings.
#define LW_PROBED_HALVINGS (LW_SCREEN_HALVINGS + 2)

// What a level brings to a receiver, each a plane of LW_PROBES floats: light with the most samples, what each halving takes of it
// by bounding its samples more, the sum of squares of what its texels send, and the share of the hemisphere that they fill.
// Light is in units of the brightest texel of the picture that was asked: squares of watts would leave float's range. The
// units follow, by row of receivers.
#define LW_PROBED_LIGHT 0
#define LW_PROBED_LOSS 1
#define LW_PROBED_SQUARES (1 + LW_PROBED_HALVINGS)
#define LW_PROBED_SHARE (2 + LW_PROBED_HALVINGS)
#define LW_PROBED_PLANES (3 + LW_PROBED_HALVINGS)
#define LW_PROBED_UNITS (LW_SCREEN_PLAN_LEVELS * LW_PROBED_PLANES * LW_PROBES)
#define LW_PROBED_FLOATS (LW_PROBED_UNITS + LW_PROBE_ROWS)

// Texels of the first level that are asked for a coarser one of their surface: columns a multiple of every LW_WIDTH.
#define LW_DETAIL_COLUMNS 64
#define LW_DETAIL_ROWS 32

// Errors of every start, level and choice, relative to the picture's light: what is lost, and the variance of noise. Behind
// them all light that receivers were told of.
#define LW_ERROR_LOST 0
#define LW_ERROR_NOISE 1
#define LW_ERROR_AT(start, level, what) ((((start) * LW_SCREEN_PLAN_LEVELS + (level)) * 2 + (what)) * LW_SCREEN_CHOICES)
#define LW_ERROR_LIGHT LW_ERROR_AT(LW_SCREEN_STARTS, 0, 0)
#define LW_ERROR_FLOATS (LW_ERROR_LIGHT + 1)

#define LW_PROBE_MOST_ROWS 64  // of texels that are asked; more are stepped over

// Rings of the levels in texels of the level that is asked: outer edge squared, area, and area by the area of one of the level's
// own texels.
typedef struct LwScreenRings {
    lw_float outer2[LW_SCREEN_PLAN_LEVELS], area[LW_SCREEN_PLAN_LEVELS], texels[LW_SCREEN_PLAN_LEVELS];
} LwScreenRings;
LW_SIZE_CHECK(LwScreenRings, 72);

#ifndef __cplusplus
LW_FN float squared(float x) { return x * x; }
#endif

#endif
