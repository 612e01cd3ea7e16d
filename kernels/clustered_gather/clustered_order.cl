// The list that a clustered gather walks: every subset's first-bounce VPLs, cluster by cluster, so that a pixel
// looks up a cluster's visibility once, then the further VPLs, which have none.
#include "shared/subset_order.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

#define LW_MOST_SORTED 64  // clusters; with more, VPLs keep their order: hardly two neighbours share one anyway

LW_FN lw_vpl of_cluster(lw_vpl vpl, int cluster) {
    vpl.flux.w = (float)cluster;
    return vpl;
}

// Index of the VPL at `place` of a subset, or -1.
LW_FN int dealt_index(lw_subset_order dealt, int subset, int place) {
    return lw_subset_index(dealt, subset * dealt.capacity + place);
}

// Where each cluster's VPLs begin in the subset: counted, then summed up. Slot clusterCount + 1 ends as their number.
LW_FN void begin_clusters(int* begin, __global const int* assignment, lw_subset_order dealt, int subset, int clusterCount) {
    for (int c = 0; c <= clusterCount; ++c) begin[c] = 0;
    for (int place = 0; place < dealt.capacity; ++place) {
        const int k = dealt_index(dealt, subset, place);
        if (k >= 0 && assignment[k] >= 0) ++begin[assignment[k] + 1];
    }
    for (int c = 0; c < clusterCount; ++c) begin[c + 1] += begin[c];
}

// One work-item = one subset of the pixels: writes its order.capacity slots. firsts, seconds: lists of VPLs by
// index, dealt to the subsets as firstOrder and secondOrder say. assignment: cluster of each first, or -1 for one
// without flux, which is left out. A slot's flux.w is its cluster, -1 for none.
__kernel void clustered_gather_order(__global const lw_vpl* firsts, __global const int* assignment,
                                     lw_subset_order firstOrder, int clusterCount, __global const lw_vpl* seconds,
                                     lw_subset_order secondOrder, lw_subset_order order, __global lw_vpl* vpls) {
    const int subset = (int)get_global_id(0);
    if (subset >= order.subsets) return;
    __global lw_vpl* out = vpls + subset * order.capacity;
    int used = 0;
    if (clusterCount <= LW_MOST_SORTED) {
        int begin[LW_MOST_SORTED + 1];
        begin_clusters(begin, assignment, firstOrder, subset, clusterCount);
        used = begin[clusterCount];
        for (int place = 0; place < firstOrder.capacity; ++place) {
            const int k = dealt_index(firstOrder, subset, place);
            if (k >= 0 && assignment[k] >= 0) out[begin[assignment[k]]++] = of_cluster(firsts[k], assignment[k]);
        }
    } else {
        for (int place = 0; place < firstOrder.capacity; ++place) {
            const int k = dealt_index(firstOrder, subset, place);
            if (k >= 0 && assignment[k] >= 0) out[used++] = of_cluster(firsts[k], assignment[k]);
        }
    }
    for (int place = 0; place < secondOrder.capacity; ++place) {
        const int k = dealt_index(secondOrder, subset, place);
        if (k >= 0) out[used++] = of_cluster(seconds[k], -1);
    }
    for (; used < order.capacity; ++used) out[used] = of_cluster(no_vpl(), -1);
}

// For debugging: one work-item = one slot of the sorted list: its cluster, -1 for none.
__kernel void clustered_gather_clusters(__global const lw_vpl* vpls, int count, __global float* planes) {
    const int i = lw_list_index();
    if (i < count) planes[i] = vpls[i].flux.w;
}
