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

// A band of every large triangle's rows at a time, until none is left.
LW_FN void draw_list(__global const float* triangles, int stride, __global const lw_paraboloid* frames, int size,
                     volatile __global uint* records, __global const lw_large_triangle* list, int count, int bands,
                     const int sweep) {
    for (int i = (int)get_global_id(0); i < count * bands; i += (int)get_global_size(0)) {
        const lw_large_triangle entry = list[i / bands];
        const int y0 = entry.rows & 0xffff, y1 = entry.rows >> 16;
        const int rows = (y1 - y0 + bands) / bands, first = y0 + (i % bands) * rows;
        if (first > y1) continue;
        const lw_canvas canvas = canvas_of(frames, records, size, entry.map);
        const lw_planes planes = planes_of(splat_corners(triangles, stride, entry.triangle, canvas.frame.origin));
        draw_rows(canvas, planes, entry.columns & 0xffff, entry.columns >> 16, first, min(first + rows - 1, y1),
                  (uint)entry.triangle, sweep);
    }
}

// Work-items share the list: its length is known on the device alone.
__kernel void paraboloid_map_depth_large(__global const float* triangles, int stride,
                                         __global const lw_paraboloid* frames, int size,
                                         volatile __global uint* records, __global const lw_large_triangle* list,
                                         __global const uint* counters, int capacity, int bands) {
    const int count = (int)min(counters[LW_MAP_LARGE], (uint)capacity);
    draw_list(triangles, stride, frames, size, records, list, count, bands, LW_DEPTH);
}

__kernel void paraboloid_map_identity_large(__global const float* triangles, int stride,
                                            __global const lw_paraboloid* frames, int size,
                                            volatile __global uint* records, __global const lw_large_triangle* list,
                                            __global const uint* counters, int capacity, int bands) {
    const int count = (int)min(counters[LW_MAP_LARGE], (uint)capacity);
    draw_list(triangles, stride, frames, size, records, list, count, bands, LW_IDENTITY);
}
