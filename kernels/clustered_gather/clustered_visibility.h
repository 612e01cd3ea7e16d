// How far a cluster of VPLs sees surfaces, as the kernels share it that gather by clusters.
#ifndef LW_CLUSTERED_VISIBILITY_H
#define LW_CLUSTERED_VISIBILITY_H

#ifndef LW_VISIBILITY
#define LW_VISIBILITY 1  // 0: none, 1: hard, 2: soft (percentage-closer), 3: through voxels, 4: strict
#endif
#include "shared/cluster_types.h"
#include "shared/paraboloid.h"
#include "shared/surface.h"
#include "voxel_sight.h"

// What the gather knows of the maps: of up to four bounces' clusters, numbered in one row: those of the second, third and fourth begin at
// lists.x, .y and .z; lists.w is a map's side. Of voxels, what all clusters see, in the same row.
typedef struct {
    __global const lw_paraboloid *frames[4];
    __global const float *records[4];
    int4 lists;
    __global const uchar* sights;
    __global const LwVoxelEye* eyes;
    __global const LwVoxelSight* sight;
} lw_maps;

// The arguments of a kernel that looks clusters up, and what it makes of them.
#define LW_MAPS_ARGUMENTS                                                                                                     \
    __global const lw_paraboloid *frames1, __global const float *records1, __global const lw_paraboloid *frames2,            \
        __global const float *records2, __global const lw_paraboloid *frames3, __global const float *records3,               \
        __global const lw_paraboloid *frames4, __global const float *records4, int4 lists, __global const uchar *sights,      \
        __global const LwVoxelEye *eyes, __global const LwVoxelSight *sight
#define LW_MAPS_OF_ARGUMENTS \
    {{frames1, frames2, frames3, frames4}, {records1, records2, records3, records4}, lists, sights, eyes, sight}

// 1 where the cluster's map sees the surface, or the share of it that does; of voxels, of its light that arrives. What stands for no cluster is seen everywhere.
// doubt: 1 where that is doubtful, which only strict look-ups tell, else 0.
LW_FN real cluster_visibility(lw_maps maps, int cluster, const lw_surface s, real* doubt) {
    *doubt = (real)0.0f;
    if (cluster < 0) return (real)1.0f;
#if LW_VISIBILITY == 0
    return (real)1.0f;
#elif LW_VISIBILITY == 3
    return voxel_sight(maps.sights, maps.eyes, maps.sight, cluster, s);
#else
    const int list = (cluster >= maps.lists.x) + (cluster >= maps.lists.y) + (cluster >= maps.lists.z);
    const int begin = list == 0 ? 0 : list == 1 ? maps.lists.x : list == 2 ? maps.lists.y : maps.lists.z;
    const int map = cluster - begin, size = maps.lists.w, first = map * size * size;
    const lw_map_receiver receiver = paraboloid_receiver(maps.frames[list][map], size, s.px, s.py, s.pz, s.nx, s.ny, s.nz);
#if LW_VISIBILITY == 1
    return ones_(paraboloid_sees(maps.records[list], first, size, receiver));
#elif LW_VISIBILITY == 4
    mask doubtful;
    const mask sees = paraboloid_sees_strictly(maps.records[list], first, size, receiver, &doubtful);
    *doubt = ones_(doubtful);
    return ones_(sees);
#else
    return paraboloid_visibility(maps.records[list], first, size, receiver);
#endif
#endif
}

// The cluster whose visibility is at hand, and one that was looked up ahead.
typedef struct {
    float cluster, last;
    real seen, lastSeen;
    real doubt, lastDoubt;
    int isDoubtful;  // some lane's
} lw_current;

LW_FN lw_current no_cluster(void) {
    const lw_current none = {-1.0f, -1.0f, (real)1.0f, (real)1.0f, (real)0.0f, (real)0.0f, 0};
    return none;
}

LW_FN int some_doubt(real doubt) { return LW_VISIBILITY == 4 && any_(doubt > 0.0f); }

LW_FN real visibility_of(lw_current* current, lw_maps maps, __global const float* vpl, const lw_surface s) {
    const float cluster = vpl[11];
    if (cluster != current->cluster) {
        current->cluster = cluster;
        if (cluster == current->last) {
            current->seen = current->lastSeen;
            current->doubt = current->lastDoubt;
        } else {
            current->seen = cluster_visibility(maps, (int)cluster, s, &current->doubt);
        }
        current->isDoubtful = some_doubt(current->doubt);
    }
    return current->seen;
}

#endif
