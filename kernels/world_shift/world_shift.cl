// Places kept from frame to frame, brought to the origin that this frame's positions are relative to.
#include "shared/vpl_list.h"

// One work-item = one place of `count`: coordinate a of place i is the float at first + i * stride + a * axis. high, low: what to add, in
// two parts: the first cancels what is large without rounding, the second has what a float cannot hold of it.
__kernel void world_shift_move(__global float* memory, int first, int stride, int axis, int count, float4 high, float4 low) {
    const int i = lw_list_index();
    if (i >= count) return;
    __global float* at = memory + first + i * stride;
    at[0] = (at[0] + high.x) + low.x;
    at[axis] = (at[axis] + high.y) + low.y;
    at[2 * axis] = (at[2 * axis] + high.z) + low.z;
}
