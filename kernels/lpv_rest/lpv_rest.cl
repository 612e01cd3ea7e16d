// Whether the light of a frame's grid is that of the frame before, so that nothing has to carry it again.
#include "shared/lpv_types.h"

// Word of LwLpvBlockers and LwSweepCover that says whether what blocks was made anew.
#define LPV_STALE 6

LW_FN int same(float4 a, float4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }

// One work-item in all. changed: what lpv_grid_resolve or lpv_sweep_resolve found. known: 1 where the host knows of nothing that has
// changed. last: the place of the frame before, which becomes this one's. state: done where the light rests.
__kernel void lpv_rest_decide(__global const int* changed, __global const LwLpvPlace* place, __global const int* blockers, int hasBlockers,
                              int known, __global LwLpvPlace* last, __global LwLpvProgress* state) {
    if (get_global_id(0) != 0) return;
    const LwLpvPlace now = *place, before = *last;
    const int isStale = hasBlockers && blockers[LPV_STALE];
    state->done = known && !changed[0] && !isStale && same(now.origin, before.origin) && same(now.cell, before.cell);
    state->scale = 1.0f;
    *last = now;
}
