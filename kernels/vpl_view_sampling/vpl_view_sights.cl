// Which candidates groups of view points see: by paraboloid maps of the groups, each drawn from the point in its middle.
#include "shared/paraboloid.h"
#include "shared/surface.h"

// One work-item = LW_WIDTH candidates (x) and a group (y). sights: a plane of `stride` floats for each group: 1 where it sees
// the candidate.
__kernel void vpl_view_sights_look(__global const float* candidates, int candidateCount, int stride,
                                   __global const lw_paraboloid* frames, __global const float* records, int size, int groups,
                                   __global float* sights) {
    const int k = (int)get_global_id(0) * LW_WIDTH, group = (int)get_global_id(1);
    if (k >= stride || group >= groups) return;
    const lanei i = 12 * min(lanei_iota() + k, (lanei)(candidateCount - 1));
    const lw_map_receiver receiver =
        paraboloid_receiver(frames[group], size, gather(candidates, i), gather(candidates, i + 1), gather(candidates, i + 2),
                            gather(candidates, i + 4), gather(candidates, i + 5), gather(candidates, i + 6));
    store(ones_(paraboloid_sees(records, group * size * size, size, receiver)), sights, group * stride + k);
}
