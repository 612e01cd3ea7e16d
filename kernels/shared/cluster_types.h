// A cluster of virtual point lights as kernels and host share it.
#ifndef LW_CLUSTER_TYPES_H
#define LW_CLUSTER_TYPES_H

#include "portable.h"

// Visibility is looked up from the medoid, which lies on a surface; the mean may float in the air or lie
// inside a wall, and leaks from there.
typedef struct {
    lw_float4 position;        // m: mean of the members' positions; w: number of members, 0 for an empty cluster
    lw_float4 normal;          // unit: normalised sum of the members' normals; w: the members' squared distances summed
    lw_float4 flux;            // W: sum of the members' flux; w: of their areas, m^2
    lw_float4 medoidPosition;  // m: of the member nearest to the mean; w: its index in the list, exact below 2^24
    lw_float4 medoidNormal;    // unit; w unused
} lw_cluster;
LW_SIZE_CHECK(lw_cluster, 80);
#define LW_CLUSTER_FLOATS 20
#define LW_CLUSTER_MEDOID 15  // the float that holds the medoid's index

// VPLs are sorted by cluster if there are no more clusters than this; with more, they keep their order: hardly two
// neighbours share one anyway.
#define LW_MOST_SORTED 64

// What stands for the number of its cluster where a gathered VPL has none: seen everywhere, beyond doubt; the same, as nobody looked: strict
// gathers let it count as far as shadowed light bears it out, at least a quarter.
#define LW_SEEN_EVERYWHERE (-1)
#define LW_UNSHADOWED (-2)

#endif
