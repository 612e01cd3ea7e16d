// The list that a clustered gather walks: of every subset of pixels the VPLs of one bounce after the other, those whose
// light is shadowed first and cluster by cluster, so that a pixel looks up a cluster's visibility once.
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

// A list fills slots.y of a subset's slots from slots.x on.
LW_FN __global lw_vpl* slots_of(__global lw_vpl* vpls, lw_subset_order order, int2 slots, int subset) {
    return vpls + subset * order.capacity + slots.x;
}

LW_FN void clear_rest(__global lw_vpl* out, int used, int count) {
    for (; used < count; ++used) out[used] = of_cluster(no_vpl(), LW_SEEN_EVERYWHERE);
}

// One work-item = one subset of the n x n: fills its slots from a list by index, sorted as above. groups: a power of
// two, n * n at most. A slot's flux.w is its cluster's number plus firstCluster.
__kernel void clustered_gather_order(__global const lw_vpl* list, __global const int* assignment,
                                     __global const int* sorted, int listCount, int firstCluster, int n, int groups,
                                     lw_subset_order order, int2 slots, __global lw_vpl* vpls) {
    const int subset = (int)get_global_id(0);
    if (subset >= order.subsets) return;
    __global lw_vpl* out = slots_of(vpls, order, slots, subset);
    const int number = spread_number(subset, n), group = number % groups;
    const int lit = sorted[listCount], end = lit * (group + 1) / groups;
    int used = 0;
    for (int place = lit * group / groups + number / groups; place < end; place += order.subsets / groups) {
        const int k = sorted[place];
        out[used++] = of_cluster(list[k], firstCluster + assignment[k]);
    }
    clear_rest(out, used, slots.y);
}

// The same from a list whose light nothing shadows, dealt out as `dealt` says. cluster: what its flux.w is, LW_SEEN_EVERYWHERE or LW_UNSHADOWED.
__kernel void clustered_gather_deal(__global const lw_vpl* list, lw_subset_order dealt, lw_subset_order order,
                                    int2 slots, int cluster, __global lw_vpl* vpls) {
    const int subset = (int)get_global_id(0);
    if (subset >= order.subsets) return;
    __global lw_vpl* out = slots_of(vpls, order, slots, subset);
    int used = 0;
    for (int place = 0; place < dealt.capacity; ++place) {
        const int k = lw_subset_index(dealt, subset * dealt.capacity + place);
        if (k >= 0) out[used++] = of_cluster(list[k], cluster);
    }
    clear_rest(out, used, slots.y);
}

// For debugging: one work-item = one slot of the sorted list: its cluster, or what stands for none.
__kernel void clustered_gather_clusters(__global const lw_vpl* vpls, int count, __global float* planes) {
    const int i = lw_list_index();
    if (i < count) planes[i] = vpls[i].flux.w;
}
