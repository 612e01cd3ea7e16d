// The list that a clustered gather walks: every subset's first-bounce VPLs, cluster by cluster, so that a pixel
// looks up a cluster's visibility once, then the further VPLs, which have none.
//
// Look-ups are what such a gather costs, so a subset may also hold VPLs of a part of the clusters only: the sorted
// list is cut into `groups` runs of equal length, and each subset of pixels takes its VPLs from one run. A window
// of n x n pixels still holds every VPL once; its mean, which is what the filter makes of it, is the same.
#include "shared/cluster_types.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

LW_FN lw_vpl of_cluster(lw_vpl vpl, int cluster) {
    vpl.flux.w = (float)cluster;
    return vpl;
}

// One work-item = one cluster; the first takes all if there are more than LW_MOST_SORTED. sorted[0 .. count): indices of
// VPLs that belong to a cluster, by cluster, then by index; sorted[count]: how many these are.
__kernel void clustered_gather_sort(__global const int* assignment, int count, int clusterCount, __global int* sorted) {
    const int cluster = (int)get_global_id(0);
    const bool all = clusterCount > LW_MOST_SORTED || clusterCount == 0;
    if (cluster >= (all ? 1 : clusterCount)) return;
    int place = 0;
    if (!all)
        for (int k = 0; k < count; ++k) place += assignment[k] >= 0 && assignment[k] < cluster;
    for (int k = 0; k < count; ++k)
        if (all ? assignment[k] >= 0 : assignment[k] == cluster) sorted[place++] = k;
    if (all || cluster == clusterCount - 1) sorted[count] = place;
}

// A number for each of the n x n subsets whose low bits differ most between neighbouring pixels: of every two side
// by side the lowest, of every 2 x 2 the two lowest, and so on. So the groups, which take the low bits, lie as close
// together as they can, and what an edge leaves of a window holds many of them.
LW_FN int spread_number(int subset, int n) {
    const int row = subset / n, column = subset % n;
    int number = 0;
    for (int bit = 0; (1 << bit) < n; ++bit)
        number |= (((row ^ column) >> bit & 1) << (2 * bit)) | ((row >> bit & 1) << (2 * bit + 1));
    return number;
}

// One work-item = one subset of the n x n: writes its order.capacity slots. firsts, seconds: lists of VPLs by index;
// sorted as above, of firstCount firsts; secondOrder deals out the seconds. groups: a power of two, n * n at most.
// A slot's flux.w is its cluster, -1 for none.
__kernel void clustered_gather_order(__global const lw_vpl* firsts, __global const int* assignment,
                                     __global const int* sorted, int firstCount, __global const lw_vpl* seconds,
                                     lw_subset_order secondOrder, int n, int groups, lw_subset_order order,
                                     __global lw_vpl* vpls) {
    const int subset = (int)get_global_id(0);
    if (subset >= order.subsets) return;
    __global lw_vpl* out = vpls + subset * order.capacity;
    const int number = spread_number(subset, n), group = number % groups;
    const int lit = sorted[firstCount], end = lit * (group + 1) / groups;
    int used = 0;
    for (int place = lit * group / groups + number / groups; place < end; place += order.subsets / groups) {
        const int k = sorted[place];
        out[used++] = of_cluster(firsts[k], assignment[k]);
    }
    for (int place = 0; place < secondOrder.capacity; ++place) {
        const int k = lw_subset_index(secondOrder, subset * secondOrder.capacity + place);
        if (k >= 0) out[used++] = of_cluster(seconds[k], -1);
    }
    for (; used < order.capacity; ++used) out[used] = of_cluster(no_vpl(), -1);
}

// For debugging: one work-item = one slot of the sorted list: its cluster, -1 for none.
__kernel void clustered_gather_clusters(__global const lw_vpl* vpls, int count, __global float* planes) {
    const int i = lw_list_index();
    if (i < count) planes[i] = vpls[i].flux.w;
}
