// K-means of virtual point lights by position and normal (Lloyd's iteration), for visibility per cluster. The squared
// distance of VPL i to a centroid C with normal n is
//   w1 |V_i - C|^2 / D^2 + w2 (1 - n_i . n),  D the diagonal of the bounding box of the VPLs that have flux:
// squared and with the dot product unclamped, so that the mean position and the normalised sum of normals minimise a
// cluster's sum exactly and no iteration raises it. Means are not weighted by flux, or one bright VPL would drag its
// cluster's centre about as lights move.
//
// Sums are taken chunk by chunk in slot order, each lane of a work-item for its own cluster: no atomics, and the same
// bits whatever the widths and work-groups. Buffers' planes: shared/kmeans_types.h.
#include "kmeans_sites.h"
#include "shared/cluster_types.h"

// One work-item = one slot, of `stride`: the list as planes. Those beyond `count` are padding, without flux.
__kernel void kmeans_unpack(__global const lw_vpl* vpls, int count, int stride, __global float* sites,
                            __global int* assignment) {
    const int i = lw_list_index();
    if (i >= stride) return;
    const lw_vpl vpl = i < count ? vpls[i] : no_vpl();
    const int lit = vpl.flux.x > 0.0f || vpl.flux.y > 0.0f || vpl.flux.z > 0.0f;
    const float values[LW_SITE_PLANES] = {vpl.positionArea.x, vpl.positionArea.y, vpl.positionArea.z,
                                          vpl.normal.x,       vpl.normal.y,       vpl.normal.z,
                                          lit ? LW_KMEANS_FAR : -1.0f};
    for (int c = 0; c < LW_SITE_PLANES; ++c) sites[c * stride + i] = values[c];
    assignment[i] = -1;
}

// The diagonal of a box, by quotients: the squares of very small or large extents leave float's range.
LW_FN float diagonal(const float* extent) {
    const float largest = fmax(extent[0], fmax(extent[1], extent[2]));
    if (!(largest > 0.0f)) return 0.0f;
    const float x = extent[0] / largest, y = extent[1] / largest, z = extent[2] / largest;
    return largest * sqrt(x * x + y * y + z * z);
}

// One work-group in all: positions become relative to the box around all VPLs with flux, and so do the means to begin
// with: the clusters `before`, or none (keep = 0).
__kernel void kmeans_frame(__global float* sites, int stride, __global const lw_cluster* before, int clusters, int keep,
                           __global float* frame, __global float* means) {
    __local float low[3 * LW_KMEANS_GROUP], high[3 * LW_KMEANS_GROUP];
    const int item = (int)get_local_id(0), items = (int)get_local_size(0);
    for (int axis = 0; axis < 3; ++axis) {
        real least = FLT_MAX, most = -FLT_MAX;
        for (int i = item * LW_WIDTH; i < stride; i += items * LW_WIDTH) {
            const mask lit = load(sites, LW_SITE_DISTANCE * stride + i) >= 0.0f;
            const real x = load(sites, axis * stride + i);
            least = select_(least, fmin(least, x), lit);
            most = select_(most, fmax(most, x), lit);
        }
        low[axis * items + item] = min_lane(least);
        high[axis * items + item] = max_lane(most);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    float centre[3], extent[3];
    for (int axis = 0; axis < 3; ++axis) {
        float least = FLT_MAX, most = -FLT_MAX;
        for (int j = 0; j < items; ++j) {
            least = fmin(least, low[axis * items + j]);
            most = fmax(most, high[axis * items + j]);
        }
        centre[axis] = least <= most ? 0.5f * least + 0.5f * most : 0.0f;
        extent[axis] = least <= most ? most - least : 0.0f;
    }
    // All VPLs at one place: their positions are then all 0. So they are when 1 / D leaves float's range.
    const float d = diagonal(extent), scale = d > 1e-37f ? 1.0f / d : 0.0f;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = item * LW_WIDTH; i < stride; i += items * LW_WIDTH)
            store((load(sites, axis * stride + i) - centre[axis]) * scale, sites, axis * stride + i);
    for (int k = item; k < LW_KMEANS_MOST; k += items) {
        float values[LW_MEAN_PLANES] = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, LW_KMEANS_FAR, 0.0f};
        if (keep && k < clusters && before[k].position.w > 0.0f) {
            const float4 position = before[k].position, normal = before[k].normal;
            values[0] = (position.x - centre[0]) * scale;
            values[1] = (position.y - centre[1]) * scale;
            values[2] = (position.z - centre[2]) * scale;
            values[3] = normal.x;
            values[4] = normal.y;
            values[5] = normal.z;
            values[LW_MEAN_AWAY] = 0.0f;
        }
        for (int c = 0; c < LW_MEAN_PLANES; ++c) means[c * LW_KMEANS_MOST + k] = values[c];
    }
    if (item == 0) {
        for (int axis = 0; axis < 3; ++axis) frame[axis] = centre[axis];
        frame[LW_KMEANS_DIAGONAL] = scale > 0.0f ? d : 0.0f;
    }
}

// One work-item = LW_WIDTH slots: the nearest mean of each, the first of several.
__kernel void kmeans_assign(__global float* sites, int stride, __global const float* means, int clusters, float2 weights,
                            __global int* assignment) {
    const int i = lw_list_index() * LW_WIDTH;
    if (i >= stride) return;
    const lw_site site = site_lanes(sites, stride, i);
    const mask lit = load(sites, LW_SITE_DISTANCE * stride + i) >= 0.0f;
    real nearest = LW_KMEANS_FAR;
    lanei cluster = -1;
    for (int k = 0; k < clusters; ++k) {
        const real d = squared_distance(site, site_splat(means, LW_KMEANS_MOST, k), weights) +
                       means[LW_MEAN_AWAY * LW_KMEANS_MOST + k];
        const mask nearer = d < nearest;
        nearest = select_(nearest, d, nearer);
        cluster = selecti_(cluster, (lanei)(k), nearer);
    }
    store(select_((real)(-1.0f), nearest, lit), sites, LW_SITE_DISTANCE * stride + i);
    store(selecti_((lanei)(-1), cluster, lit), assignment, i);
}

// One work-item = one chunk of slots and LW_WIDTH clusters: the chunk's part in their sums.
__kernel void kmeans_sums(__global const float* sites, int stride, __global const int* assignment, int clusters,
                          __global float* partials) {
    int chunk, first;
    chunk_and_clusters(clusters, &chunk, &first);
    const int begin = chunk * LW_KMEANS_CHUNK, end = min(begin + LW_KMEANS_CHUNK, stride);
    const lanei cluster = first + lanei_iota();
    lw_site sum;
    sum.x = sum.y = sum.z = sum.nx = sum.ny = sum.nz = 0.0f;
    real members = 0.0f;
    for (int i = begin; i < end; ++i) {
        const mask mine = cluster == assignment[i];
        const lw_site site = site_splat(sites, stride, i);
        sum.x = select_(sum.x, sum.x + site.x, mine);
        sum.y = select_(sum.y, sum.y + site.y, mine);
        sum.z = select_(sum.z, sum.z + site.z, mine);
        sum.nx = select_(sum.nx, sum.nx + site.nx, mine);
        sum.ny = select_(sum.ny, sum.ny + site.ny, mine);
        sum.nz = select_(sum.nz, sum.nz + site.nz, mine);
        members += ones_(mine);
    }
    if (begin >= end) return;
    __global float* out = partials + chunk * LW_PARTIAL_PLANES * LW_KMEANS_MOST;
    store_site(sum, out, LW_KMEANS_MOST, first);
    store(members, out, LW_PARTIAL_MEMBERS * LW_KMEANS_MOST + first);
}

// One work-item = LW_WIDTH clusters: their means from the sums of all chunks.
__kernel void kmeans_update(__global const float* sites, int stride, __global const int* assignment, int clusters,
                            __global const float* partials, __global float* means) {
    const int first = (int)get_global_id(0) * LW_WIDTH;
    if (first >= clusters) return;
    lw_site sum;
    sum.x = sum.y = sum.z = sum.nx = sum.ny = sum.nz = 0.0f;
    real members = 0.0f;
    for (int chunk = 0; chunk * LW_KMEANS_CHUNK < stride; ++chunk) {
        __global const float* part = partials + chunk * LW_PARTIAL_PLANES * LW_KMEANS_MOST;
        const lw_site s = site_lanes(part, LW_KMEANS_MOST, first);
        sum.x += s.x;
        sum.y += s.y;
        sum.z += s.z;
        sum.nx += s.nx;
        sum.ny += s.ny;
        sum.nz += s.nz;
        members += load(part, LW_PARTIAL_MEMBERS * LW_KMEANS_MOST + first);
    }
    const mask alive = members > 0.0f;
    const real share = 1.0f / fmax(members, (real)(1.0f));
    // A sum that is nothing but rounding has no direction to trust: any normal is then as near to the members' as any
    // other, and that of the first member is one of a surface.
    const real square = fma_(sum.nz, sum.nz, fma_(sum.ny, sum.ny, sum.nx * sum.nx));
    mask cancelled = and_(alive, square <= 1e-12f * members * members);
    const real length = sqrt(select_(square, (real)(1.0f), or_(cancelled, not_(alive))));
    lw_site mean;
    mean.x = sum.x * share;
    mean.y = sum.y * share;
    mean.z = sum.z * share;
    mean.nx = sum.nx / length;
    mean.ny = sum.ny / length;
    mean.nz = sum.nz / length;
    const lanei cluster = first + lanei_iota();
    for (int i = 0; i < stride && any_(cancelled); ++i) {
        const mask mine = and_(cancelled, cluster == assignment[i]);
        const lw_site site = site_splat(sites, stride, i);
        mean.nx = select_(mean.nx, site.nx, mine);
        mean.ny = select_(mean.ny, site.ny, mine);
        mean.nz = select_(mean.nz, site.nz, mine);
        cancelled = and_(cancelled, not_(mine));
    }
    store_site(mean, means, LW_KMEANS_MOST, first);
    store(select_((real)(LW_KMEANS_FAR), (real)(0.0f), alive), means, LW_MEAN_AWAY * LW_KMEANS_MOST + first);
    store(members, means, LW_MEAN_MEMBERS * LW_KMEANS_MOST + first);
}
