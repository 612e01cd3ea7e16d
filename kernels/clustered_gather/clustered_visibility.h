// How far a cluster of VPLs sees surfaces, as the kernels share it that gather by clusters.
#ifndef LW_CLUSTERED_VISIBILITY_H
#define LW_CLUSTERED_VISIBILITY_H

#ifndef LW_VISIBILITY
#define LW_VISIBILITY 1  // 0: none, 1: hard, 2: soft (percentage-closer), 3: through voxels
#endif
#include "shared/paraboloid.h"
#include "shared/surface.h"
#include "voxel_sight.h"

// What the gather knows of the maps: those of the first bounce's clusters, and from cluster number `seconds` on those
// of the second's; of voxels, what all clusters see, both bounces' in one row.
typedef struct {
    __global const lw_paraboloid* frames;
    __global const float* records;
    __global const lw_paraboloid* secondFrames;
    __global const float* secondRecords;
    int seconds, size;
    __global const uchar* sights;
    __global const LwVoxelEye* eyes;
    __global const LwVoxelSight* sight;
} lw_maps;

// 1 where the cluster's map sees the surface, or the share of it that does; of voxels, of its light that arrives. Cluster -1 is seen everywhere.
LW_FN real cluster_visibility(lw_maps maps, int cluster, const lw_surface s) {
    if (cluster < 0) return (real)1.0f;
#if LW_VISIBILITY == 0
    return (real)1.0f;
#elif LW_VISIBILITY == 3
    return voxel_sight(maps.sights, maps.eyes, maps.sight, cluster, s);
#else
    const bool isSecond = cluster >= maps.seconds;
    const int map = isSecond ? cluster - maps.seconds : cluster, first = map * maps.size * maps.size;
    const lw_paraboloid frame = isSecond ? maps.secondFrames[map] : maps.frames[map];
    __global const float* const records = isSecond ? maps.secondRecords : maps.records;
    const lw_map_receiver receiver = paraboloid_receiver(frame, maps.size, s.px, s.py, s.pz, s.nx, s.ny, s.nz);
#if LW_VISIBILITY == 1
    return ones_(paraboloid_sees(records, first, maps.size, receiver));
#else
    return paraboloid_visibility(records, first, maps.size, receiver);
#endif
#endif
}

// The cluster whose visibility is at hand, and one that was looked up ahead.
typedef struct {
    float cluster, last;
    real seen, lastSeen;
} lw_current;

LW_FN real visibility_of(lw_current* current, lw_maps maps, __global const float* vpl, const lw_surface s) {
    const float cluster = vpl[11];
    if (cluster != current->cluster) {
        current->cluster = cluster;
        current->seen = cluster == current->last ? current->lastSeen : cluster_visibility(maps, (int)cluster, s);
    }
    return current->seen;
}

#endif
