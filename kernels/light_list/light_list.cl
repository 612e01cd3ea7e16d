// Static VPLs that are strong enough to be lights, as lists of VPLs by slot.
#include "shared/static_vpl_types.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"

// A threshold relative to the strongest is never above this share of it, up to what its sum is rounded otherwise: where
// `threshold` times `hysteresis` is 1 or more, nothing would come back after the dark.
#define LW_STRONGEST 0.9999f

// One work-item = one slot. A place whose mean intensity over the channels is below `threshold` is left out; one that
// was out must reach `hysteresis` times that. `kept`: an int per place, 1 where it was in the frame before. relative:
// the threshold is a share of the frame's strongest. baked: the same of what receivers with baked light get, where
// that is another list (lists: 2). Slots beyond the places are other passes' (and empty until they have written
// them).
__kernel void light_list_cull(__global float* inputs, lw_static_frame frame, __global const float* lit, float threshold,
                              int relative, float hysteresis, __global int* kept, lw_subset_order order, int lists,
                              __global lw_vpl* vpls, __global lw_vpl* baked) {
    const int slot = lw_list_index();
    if (slot >= order.subsets * order.capacity) return;
    const int k = lw_subset_index(order, slot);
    lw_vpl first = no_vpl(), second = no_vpl();
    if (k >= 0 && k < frame.count) {
        __global const float* place = inputs + frame.places + k;
        float flux[6], sum[2] = {0.0f, 0.0f};
        for (int c = 0; c < 6; ++c) {
            flux[c] = lit[c * frame.stride + k];
            sum[c / 3] += flux[c];
        }
        const float intensity = fmax(sum[0], sum[1]) * (M_1_PI_F / 3.0f);
        const float most = relative ? LW_STRONGEST * inputs[LW_FRAME_STRONGEST] : INFINITY;
        const float least = fmin(relative ? threshold * inputs[LW_FRAME_STRONGEST] : threshold, most);
        const int keep = intensity > 0.0f && intensity >= (kept[k] ? least : fmin(least * hysteresis, most));
        kept[k] = keep;
        if (keep) {
            atomic_inc((__global int*)inputs + LW_FRAME_KEPT);
            first.positionArea = (float4)(place[0], place[frame.stride], place[2 * frame.stride],
                                          lit[LW_LIT_AREA * frame.stride + k]);
            first.normal = (float4)(place[3 * frame.stride], place[4 * frame.stride], place[5 * frame.stride], 0.0f);
            second = first = bounded(first);
            first.flux = (float4)(flux[0], flux[1], flux[2], 0.0f);
            second.flux = (float4)(flux[3], flux[4], flux[5], 0.0f);
        }
    }
    vpls[slot] = first;
    if (lists > 1) baked[slot] = second;
}
