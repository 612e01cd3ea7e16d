// A mean for every cluster without members. When no cluster has any (the first frame, a cut): k-means++ (Arthur &
// Vassilvitskii 2007), a VPL drawn with a probability in proportion to its squared distance from the means so far.
// Otherwise the VPL that is farthest from its mean. Both one after another, the distances and the assignment brought
// up to date between two, so that no VPL is taken twice; VPLs that coincide with a mean never are, so that clusters stay
// empty rather than double when there are fewer places than clusters.
#include "kmeans_sites.h"

// -ln of a random number in (0, 1) that slot and round determine. Written out, so that all widths draw alike; the
// series in s = (m - 1) / (m + 1), |s| < 0.172, is good to 1e-7.
LW_FN real exponential_variate(lanei slot, int round) {
    laneu h = to_laneu(slot) * 0x9e3779b9u + (uint)round * 0xc2b2ae3du + 0x27d4eb2fu;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    h ^= h >> 16;
    const real u = (to_real(h >> 9) + 0.5f) * (1.0f / 8388608.0f);
    // u = m 2^e with m in [sqrt(1/2), sqrt(2)): a u near 1 has e = 0 and nothing cancels.
    const lanei bits = as_lanei_(u), e = (bits - 0x3f3504f3) >> 23;
    const real m = as_real_(bits - e * 0x800000);
    const real s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
    const real series = fma_(fma_(fma_(s2, 1.0f / 7.0f, 0.2f), s2, 1.0f / 3.0f), s2, 1.0f);
    return -fma_(to_real(e), 0.69314718f, 2.0f * s * series);
}

// Notes which clusters own some of these slots: one bit each.
LW_FN void mark_owners(lanei owner, laneu* low, laneu* high) {
    const laneu bit = (laneu)(1u) << (to_laneu(max(owner, (lanei)(0))) & 31u);
    *low |= selectu_((laneu)(0u), bit, and_(owner >= 0, owner < 32));
    *high |= selectu_((laneu)(0u), bit, owner >= 32);
}

// The first of `clusters` whose bit is missing, or -1. `owners`: words of all lanes, those of clusters 0 to 31 first; `low`
// and `high`: clusters that shall have none.
LW_FN int first_without(__local const uint* owners, int clusters, uint low, uint high) {
    for (int l = 0; l < LW_KMEANS_GROUP; ++l) {
        low |= owners[l];
        high |= owners[LW_KMEANS_GROUP + l];
    }
    for (int k = 0; k < clusters; ++k)
        if (!(((k < 32 ? low : high) >> (k & 31)) & 1u)) return k;
    return -1;
}

// This work-item's best slot: the greatest squared distance, or, `draw`, the greatest quotient of it and an exponential
// variate. That quotient is greatest with a probability in proportion to the distance (Efraimidis & Spirakis 2006), and
// a maximum, other than sums to search in, does not depend on the order.
LW_FN void best_slot(__global const float* distances, int stride, int draw, int round, float* key, int* slot) {
    real best = 0.0f;
    lanei at = 0x7fffffff;
    for (int i = (int)get_local_id(0) * LW_WIDTH; i < stride; i += (int)get_local_size(0) * LW_WIDTH) {
        const lanei here = i + lanei_iota();
        real d = load(distances, i);
        if (draw) d = d / exponential_variate(here, round);
        const mask better = d > best;
        best = select_(best, d, better);
        at = selecti_(at, here, better);
    }
    *key = max_lane(best);
    *slot = mini_lane(selecti_((lanei)(0x7fffffff), at, best == *key));
}

// Gives this work-item's slots to cluster `seeded` where its new mean is nearer than theirs, and notes all owners.
LW_FN void capture(__global float* sites, int stride, __global int* assignment, lw_site mean, int seeded, float2 weights,
                   __local uint* owners) {
    laneu low = 0u, high = 0u;
    const int item = (int)get_local_id(0);
    for (int i = item * LW_WIDTH; i < stride; i += (int)get_local_size(0) * LW_WIDTH) {
        const real old = load(sites, LW_SITE_DISTANCE * stride + i);
        const lanei owner = loadi(assignment, i);
        const real d = squared_distance(site_lanes(sites, stride, i), mean, weights);
        // As when all means are compared: of several nearest ones the first. (Nothing is below a slot without flux.)
        const mask nearer = or_(d < old, and_(d == old, owner > seeded));
        const lanei now = selecti_(owner, (lanei)(seeded), nearer);
        store(select_(old, d, nearer), sites, LW_SITE_DISTANCE * stride + i);
        store(now, assignment, i);
        mark_owners(now, &low, &high);
    }
    store(low, owners, item * LW_WIDTH);
    store(high, owners, LW_KMEANS_GROUP + item * LW_WIDTH);
}

// One work-group in all, of LW_KMEANS_GROUP / LW_WIDTH work-items. dead: two words of clusters that stay empty, read if
// hasDead.
__kernel void kmeans_seed(__global float* sites, int stride, __global int* assignment, int clusters, float2 weights,
                          int hasDead, __global const int* dead, __global float* means) {
    __local uint owners[2 * LW_KMEANS_GROUP];
    __local float keys[LW_KMEANS_GROUP];
    __local int slots[LW_KMEANS_GROUP];
    const int item = (int)get_local_id(0), items = (int)get_local_size(0);
    laneu low = 0u, high = 0u;
    for (int i = item * LW_WIDTH; i < stride; i += items * LW_WIDTH) mark_owners(loadi(assignment, i), &low, &high);
    store(low, owners, item * LW_WIDTH);
    store(high, owners, LW_KMEANS_GROUP + item * LW_WIDTH);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint deadLow = hasDead ? as_uint(dead[0]) : 0u, deadHigh = hasDead ? as_uint(dead[1]) : 0u;
    int seeded = first_without(owners, clusters, deadLow, deadHigh);
    int draw = 1;
    for (int l = 0; l < 2 * LW_KMEANS_GROUP; ++l) draw = draw && !owners[l];

    // A seed may take a cluster's last member: as many rounds as clusters are more than enough in practice, and end.
    for (int round = 0; round < clusters && seeded >= 0; ++round) {
        float key;
        int slot;
        best_slot(sites + LW_SITE_DISTANCE * stride, stride, draw, round, &key, &slot);
        keys[item] = key;
        slots[item] = slot;
        barrier(CLK_LOCAL_MEM_FENCE);
        key = 0.0f;
        slot = -1;
        for (int j = 0; j < items; ++j)
            if (keys[j] > key || (keys[j] == key && slots[j] < slot)) {
                key = keys[j];
                slot = slots[j];
            }
        if (slot >= 0) {
            const lw_site mean = site_splat(sites, stride, slot);
            if (item == 0) {
                for (int c = 0; c < LW_SITE_DISTANCE; ++c)
                    means[c * LW_KMEANS_MOST + seeded] = sites[c * stride + slot];
                means[LW_MEAN_AWAY * LW_KMEANS_MOST + seeded] = 0.0f;
            }
            capture(sites, stride, assignment, mean, seeded, weights, owners);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        seeded = slot >= 0 ? first_without(owners, clusters, deadLow, deadHigh) : -1;
    }
}
