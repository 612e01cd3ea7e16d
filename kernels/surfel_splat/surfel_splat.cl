// The sweeps of the pass surfel_splat over the surfels. Planes of `surfels` are `stride` floats apart; rows of `candidates`
// (a word per map and block, a bit per surfel) `blocks` words.
#include "surfel_splat.h"

LW_FN lw_canvas canvas_of(__global const lw_paraboloid* frames, volatile __global uint* records,
                          volatile __global uint* albedo, int size, int map) {
    lw_canvas c;
    c.frame = frames[map];
    c.records = records;
    c.albedo = albedo;
    c.size = size;
    c.first = map * size * size;
    c.step = paraboloid_step(size);
    return c;
}

// One work-item = one texel (x) of a map (y): no albedo yet. Distances and normals are paraboloid_map's to clear.
__kernel void surfel_splat_clear(__global const int* states, int texels, __global uint* albedo) {
    const int texel = (int)get_global_id(0), map = (int)get_global_id(1);
    if (texel < texels && (states[map] & LW_MAP_STALE)) albedo[map * texels + texel] = 0xffffffffu;
}

// One work-item = a block of surfels (x), on LW_MAPS_PER_ITEM maps (y): what it loads serves all of them. And the blocks that
// lie the grid's width apart: a grid is never so wide that a driver compiles the kernel anew for it.
__kernel void surfel_splat_depth(__global const float* surfels, int stride, int blocks, __global const lw_paraboloid* frames,
                                 __global const int* states, int mapCount, int size, uint threshold, float scale,
                                 volatile __global uint* records, volatile __global uint* albedo,
                                 __global uint* candidates) {
    const int firstMap = (int)get_global_id(1) * LW_MAPS_PER_ITEM;
    for (int block = (int)get_global_id(0); block < blocks; block += (int)get_global_size(0))
        for (int map = firstMap; map < min(firstMap + LW_MAPS_PER_ITEM, mapCount); ++map) {
            if (!(states[map] & LW_MAP_DRAWN)) continue;
            const lw_canvas canvas = canvas_of(frames, records, albedo, size, map);
            uint reached = 0;
            for (int i = 0; i < LW_SURFEL_BLOCK; i += LW_WIDTH)
                reached |= draw_batch(canvas, surfels, stride, block * LW_SURFEL_BLOCK + i, 0xffffffffu, map, threshold, scale,
                                      LW_DEPTH) << i;
            candidates[map * blocks + block] = reached;
        }
}

// The same for the surfels that the first sweep noted; those that stay nearest are always among them.
LW_FN void draw_noted(__global const float* surfels, int stride, int blocks, __global const lw_paraboloid* frames,
                      __global const int* states, int mapCount, int size, uint threshold, float scale,
                      volatile __global uint* records, volatile __global uint* albedo, __global const uint* candidates,
                      const int sweep) {
    const int firstMap = (int)get_global_id(1) * LW_MAPS_PER_ITEM;
    for (int block = (int)get_global_id(0); block < blocks; block += (int)get_global_size(0))
        for (int map = firstMap; map < min(firstMap + LW_MAPS_PER_ITEM, mapCount); ++map) {
            if (!(states[map] & LW_MAP_DRAWN)) continue;
            const uint noted = candidates[map * blocks + block];
            if (!noted) continue;
            const lw_canvas canvas = canvas_of(frames, records, albedo, size, map);
            for (int i = 0; i < LW_SURFEL_BLOCK; i += LW_WIDTH)
                if (noted >> i)
                    draw_batch(canvas, surfels, stride, block * LW_SURFEL_BLOCK + i, noted >> i, map, threshold, scale, sweep);
        }
}

__kernel void surfel_splat_normal(__global const float* surfels, int stride, int blocks, __global const lw_paraboloid* frames,
                                  __global const int* states, int mapCount, int size, uint threshold, float scale,
                                  volatile __global uint* records, volatile __global uint* albedo,
                                  __global const uint* candidates) {
    draw_noted(surfels, stride, blocks, frames, states, mapCount, size, threshold, scale, records, albedo, candidates,
               LW_NORMAL);
}

__kernel void surfel_splat_albedo(__global const float* surfels, int stride, int blocks, __global const lw_paraboloid* frames,
                                  __global const int* states, int mapCount, int size, uint threshold, float scale,
                                  volatile __global uint* records, volatile __global uint* albedo,
                                  __global const uint* candidates) {
    draw_noted(surfels, stride, blocks, frames, states, mapCount, size, threshold, scale, records, albedo, candidates,
               LW_ALBEDO);
}

// One work-item = one texel (x) of a map (y): what no surfel reached becomes what a map says of texels that met nothing.
__kernel void surfel_splat_resolve(__global const int* states, int texels, __global uint* records, __global uint* albedo) {
    const int texel = (int)get_global_id(0), map = (int)get_global_id(1);
    if (texel >= texels || !(states[map] & LW_MAP_STALE)) return;
    const int at = map * texels + texel;
    if (records[2 * at + 1] != 0xffffffffu) return;
    records[2 * at + 1] = 0;
    albedo[at] = 0;
}
