// The clusters that k-means ends with: means in the world, flux, medoids. Also every VPL as a cluster of its own.
#include "kmeans_sites.h"
#include "shared/cluster_types.h"

// Its normal is a unit vector, so that a frame built on it stays finite.
LW_FN lw_cluster no_cluster(void) {
    lw_cluster cluster;
    cluster.position = cluster.flux = (float4)(0.0f);
    cluster.normal = cluster.medoidNormal = (float4)(0.0f, 0.0f, 1.0f, 0.0f);
    cluster.medoidPosition = (float4)(0.0f, 0.0f, 0.0f, -1.0f);
    return cluster;
}

// The medoids that clusters had in the frame before, by slot; -1 where a cluster had none, or begins.
LW_FN real former_medoids(__global const lw_cluster* before, lanei cluster, int clusters, int keep) {
    if (!keep) return (real)-1.0f;
    const lanei k = min(cluster, (lanei)(clusters - 1));
    return gather((__global const float*)before, k * (lanei)LW_CLUSTER_FLOATS + (lanei)LW_CLUSTER_MEDOID);
}

// One work-item = one chunk of slots and LW_WIDTH clusters: flux, area, spread and the member nearest to the mean, the first
// of several, of the chunk's slots. A medoid of the frame before counts as nearer than it is.
__kernel void kmeans_members(__global const lw_vpl* vpls, int count, __global const float* sites, int stride,
                             __global const int* assignment, __global const float* means,
                             __global const lw_cluster* before, int clusters, int keep, float2 weights,
                             __global float* partials) {
    int chunk, first;
    chunk_and_clusters(clusters, &chunk, &first);
    const int begin = chunk * LW_KMEANS_CHUNK, end = min(begin + LW_KMEANS_CHUNK, count);
    const lanei cluster = first + lanei_iota();
    const lw_site mean = site_lanes(means, LW_KMEANS_MOST, first);
    const real former = former_medoids(before, cluster, clusters, keep);
    real spread = 0.0f, red = 0.0f, green = 0.0f, blue = 0.0f, area = 0.0f, nearest = LW_KMEANS_FAR, at = -1.0f;
    for (int i = begin; i < end; ++i) {
        const mask mine = cluster == assignment[i];
        const float4 flux = vpls[i].flux;
        const float itsArea = vpls[i].positionArea.w;
        const real d = squared_distance(site_splat(sites, stride, i), mean, weights);
        spread = select_(spread, spread + d, mine);
        red = select_(red, red + flux.x, mine);
        green = select_(green, green + flux.y, mine);
        blue = select_(blue, blue + flux.z, mine);
        area = select_(area, area + itsArea, mine);
        const real slot = (real)((float)i);
        const real weighed = select_(d, d * LW_MEDOID_STAYS, slot == former);
        const mask nearer = and_(mine, weighed < nearest);
        nearest = select_(nearest, weighed, nearer);
        at = select_(at, slot, nearer);
    }
    if (begin >= stride) return;
    __global float* out = partials + chunk * LW_PARTIAL_PLANES * LW_KMEANS_MOST + first;
    store(spread, out, LW_PARTIAL_SPREAD * LW_KMEANS_MOST);
    store(red, out, LW_PARTIAL_FLUX * LW_KMEANS_MOST);
    store(green, out, (LW_PARTIAL_FLUX + 1) * LW_KMEANS_MOST);
    store(blue, out, (LW_PARTIAL_FLUX + 2) * LW_KMEANS_MOST);
    store(area, out, LW_PARTIAL_AREA * LW_KMEANS_MOST);
    store(nearest, out, LW_PARTIAL_NEAREST * LW_KMEANS_MOST);
    store(at, out, LW_PARTIAL_SLOT * LW_KMEANS_MOST);
}

// One work-item = one cluster: all chunks' parts, and the mean back in the world.
__kernel void kmeans_finish(__global const lw_vpl* vpls, int stride, __global const float* partials,
                            __global const float* means, __global const float* frame, int clusters,
                            __global lw_cluster* out) {
    const int k = (int)get_global_id(0);
    if (k >= clusters) return;
    float spread = 0.0f, nearest = LW_KMEANS_FAR, at = -1.0f;
    float4 flux = (float4)(0.0f);
    for (int chunk = 0; chunk * LW_KMEANS_CHUNK < stride; ++chunk) {
        __global const float* part = partials + chunk * LW_PARTIAL_PLANES * LW_KMEANS_MOST + k;
        spread += part[LW_PARTIAL_SPREAD * LW_KMEANS_MOST];
        flux.x += part[LW_PARTIAL_FLUX * LW_KMEANS_MOST];
        flux.y += part[(LW_PARTIAL_FLUX + 1) * LW_KMEANS_MOST];
        flux.z += part[(LW_PARTIAL_FLUX + 2) * LW_KMEANS_MOST];
        flux.w += part[LW_PARTIAL_AREA * LW_KMEANS_MOST];
        const float d = part[LW_PARTIAL_NEAREST * LW_KMEANS_MOST];
        if (d < nearest) {
            nearest = d;
            at = part[LW_PARTIAL_SLOT * LW_KMEANS_MOST];
        }
    }
    if (!(at >= 0.0f)) {
        out[k] = no_cluster();
        return;
    }
    __global const float* mean = means + k;
    const float d = frame[LW_KMEANS_DIAGONAL];
    const lw_vpl medoid = vpls[(int)at];
    lw_cluster cluster;
    cluster.position = (float4)(mean[0] * d + frame[0], mean[LW_KMEANS_MOST] * d + frame[1],
                                mean[2 * LW_KMEANS_MOST] * d + frame[2], mean[LW_MEAN_MEMBERS * LW_KMEANS_MOST]);
    cluster.normal = (float4)(mean[3 * LW_KMEANS_MOST], mean[4 * LW_KMEANS_MOST], mean[5 * LW_KMEANS_MOST], spread);
    cluster.flux = flux;
    cluster.medoidPosition = (float4)(medoid.positionArea.xyz, at);
    cluster.medoidNormal = (float4)(medoid.normal.xyz, 0.0f);
    out[k] = cluster;
}

// One work-item = one slot: a cluster of its own, empty without flux.
__kernel void kmeans_identity(__global const lw_vpl* vpls, int count, __global int* assignment, __global lw_cluster* out) {
    const int i = lw_list_index();
    if (i >= count) return;
    const lw_vpl vpl = vpls[i];
    const int lit = vpl.flux.x > 0.0f || vpl.flux.y > 0.0f || vpl.flux.z > 0.0f;
    lw_cluster cluster = no_cluster();
    if (lit) {
        cluster.position = (float4)(vpl.positionArea.xyz, 1.0f);
        cluster.normal = cluster.medoidNormal = (float4)(vpl.normal.xyz, 0.0f);
        cluster.flux = (float4)(vpl.flux.xyz, vpl.positionArea.w);
        cluster.medoidPosition = (float4)(vpl.positionArea.xyz, (float)i);
    }
    assignment[i] = lit ? i : -1;
    out[i] = cluster;
}

// For debugging: sixteen planes (position, normal, flux, members, the medoid's position and normal) by cluster.
__kernel void kmeans_planes(__global const lw_cluster* clusters, int count, __global float* planes, int planeStride) {
    const int i = lw_list_index();
    if (i >= count) return;
    const lw_cluster c = clusters[i];
    const float values[16] = {c.position.x,       c.position.y,       c.position.z,       c.normal.x,
                              c.normal.y,         c.normal.z,         c.flux.x,           c.flux.y,
                              c.flux.z,           c.position.w,       c.medoidPosition.x, c.medoidPosition.y,
                              c.medoidPosition.z, c.medoidNormal.x,   c.medoidNormal.y,   c.medoidNormal.z};
    for (int p = 0; p < 16; ++p) planes[p * planeStride + i] = values[p];
}
