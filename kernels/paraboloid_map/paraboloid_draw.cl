// The two sweeps of the pass paraboloid_map over the triangles, and over those that are large on their map.
// Planes of `triangles` are `stride` floats apart; planes of `groups` (centre xyz, radius) and rows of `candidates`
// (a word per map and group, a bit per triangle) `groupCount`, a multiple of 16.
#include "paraboloid_draw.h"

// One work-item = LW_WIDTH groups of 16 triangles (x), on LW_MAPS_PER_ITEM maps (y): what it loads serves all of
// them.
__kernel void paraboloid_map_depth(__global const float* triangles, int stride, __global const float* groups,
                                   int groupCount, __global const lw_paraboloid* frames,
                                   __global const int* states, int mapCount, int size,
                                   volatile __global uint* records, __global uint* candidates,
                                   __global lw_large_triangle* list, volatile __global uint* counters, int capacity) {
    const int firstGroup = (int)get_global_id(0) * LW_WIDTH;
    const int firstMap = (int)get_global_id(1) * LW_MAPS_PER_ITEM;
    if (firstGroup >= groupCount) return;
    const real cx = load(groups, firstGroup), cy = load(groups, firstGroup + groupCount),
               cz = load(groups, firstGroup + 2 * groupCount), radius = load(groups, firstGroup + 3 * groupCount);
    lw_large_list large;
    large.list = list;
    large.counters = counters;
    large.capacity = capacity;
    for (int map = firstMap; map < min(firstMap + LW_MAPS_PER_ITEM, mapCount); ++map) {
        if (!(states[map] & LW_MAP_DRAWN)) continue;
        const lw_canvas canvas = canvas_of(frames, records, size, map);
        int covers[LW_WIDTH];
        store(box_of_spheres(canvas.frame, size, cx, cy, cz, radius).any, covers, 0);
        for (int g = 0; g < LW_WIDTH; ++g) {
            uint reached = 0;
            if (covers[g])
                reached = draw_group(canvas, triangles, stride, firstGroup + g, 0xffffu, map, large, LW_DEPTH);
            candidates[map * groupCount + firstGroup + g] = reached;
        }
    }
}

// The same for the triangles that the first sweep noted.
__kernel void paraboloid_map_identity(__global const float* triangles, int stride, int groupCount,
                                      __global const lw_paraboloid* frames, __global const int* states, int mapCount,
                                      int size, volatile __global uint* records, __global const uint* candidates) {
    const int firstGroup = (int)get_global_id(0) * LW_WIDTH;
    const int firstMap = (int)get_global_id(1) * LW_MAPS_PER_ITEM;
    if (firstGroup >= groupCount) return;
    lw_large_list none;
    none.list = 0;
    none.counters = 0;
    none.capacity = 0;
    for (int map = firstMap; map < min(firstMap + LW_MAPS_PER_ITEM, mapCount); ++map) {
        if (!(states[map] & LW_MAP_DRAWN)) continue;
        __global const uint* noted = candidates + map * groupCount + firstGroup;
        if (!any_(to_mask(loadi((__global const int*)noted, 0)))) continue;
        const lw_canvas canvas = canvas_of(frames, records, size, map);
        for (int g = 0; g < LW_WIDTH; ++g)
            if (noted[g])
                draw_group(canvas, triangles, stride, firstGroup + g, noted[g], map, none, LW_IDENTITY);
    }
}

// A row of tiles of every large triangle at a time, until none is left; in the second sweep those where the first
// reached a texel.
LW_FN void draw_list(__global const float* triangles, int stride, __global const lw_paraboloid* frames, int size,
                     volatile __global uint* records, __global lw_large_triangle* list, int count, const int sweep) {
    const int tileRows = size / LW_TILE;
    for (int i = (int)get_global_id(0); i < count * tileRows; i += (int)get_global_size(0)) {
        __global lw_large_triangle* entry = list + i / tileRows;
        const int tileY = i % tileRows, map = entry->map, triangle = entry->triangle;
        if (tileY < (entry->rows & 0xffff) || tileY > (entry->rows >> 16)) continue;
        if (sweep == LW_IDENTITY && !(entry->reached >> tileY & 1)) continue;
        const lw_canvas canvas = canvas_of(frames, records, size, map);
        const lw_planes planes = planes_of(splat_corners(triangles, stride, triangle, canvas.frame.origin));
        if (draw_tiles(canvas, planes, entry->columns & 0xffff, entry->columns >> 16, tileY, (uint)triangle, sweep))
            atomic_or((volatile __global uint*)&entry->reached, 1u << tileY);
    }
}

// Work-items share the list: its length is known on the device alone.
__kernel void paraboloid_map_depth_large(__global const float* triangles, int stride,
                                         __global const lw_paraboloid* frames, int size,
                                         volatile __global uint* records, __global lw_large_triangle* list,
                                         __global const uint* counters, int capacity) {
    const int count = (int)min(counters[LW_MAP_LARGE], (uint)capacity);
    draw_list(triangles, stride, frames, size, records, list, count, LW_DEPTH);
}

__kernel void paraboloid_map_identity_large(__global const float* triangles, int stride,
                                            __global const lw_paraboloid* frames, int size,
                                            volatile __global uint* records, __global lw_large_triangle* list,
                                            __global const uint* counters, int capacity) {
    const int count = (int)min(counters[LW_MAP_LARGE], (uint)capacity);
    draw_list(triangles, stride, frames, size, records, list, count, LW_IDENTITY);
}
