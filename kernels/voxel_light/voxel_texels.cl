// Texels of the reflective shadow maps in voxels: which voxel each lies in, and texels in the order of
// bricks.
//
// A texel on a wall along a voxel's border may lie beside the wall's voxel. One whose voxel holds no
// surface lies half a voxel below itself, or above; or, where there is none either (a normal map's
// normal, a grazing wall, one that the map sees coarser than the voxels), in the nearest of the 26 next
// to it that holds some.
//
// What the last frame had of a texel is kept: only bricks that a texel has come to, left or lit otherwise
// are added up again. By a sort instead of sums in memory: atomic additions of single texels took ten
// times as long. LW_LIGHT_ROWS runs of texels are sorted for themselves, each by one work-item.
#include "shared/grid_types.h"
#include "shared/rsm_types.h"
#include "shared/voxel_light_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

// Texels of a work-item.
#define LIGHT_RUN 64
// Slots that a work-item remembers; a power of two.
#define LIGHT_MARKED 16
// Half a voxel: far enough from a wall on a voxel's border to the voxel that holds the wall, too near
// for the voxel behind that one.
#define LIGHT_NUDGE 0.5f

LW_FN int is_in_grid(float x, float y, float z, float most) {
    return x >= 0.0f && x < most && y >= 0.0f && y < most && z >= 0.0f && z < most;
}

// The voxel's number among all slots' voxels, and 1; 0: no surface.
LW_FN uint voxel_key(int i, int j, int k, LwVoxelContents contents, __global const int* bricks,
                     __global const float* areas) {
    const int side = contents.size / LW_VOXEL_BRICK;
    const int slot = bricks[((k >> 3) * side + (j >> 3)) * side + (i >> 3)];
    if (slot < 0) return 0;
    const int at = slot * LW_VOXEL_BRICK_VOXELS + ((i & 7) | (j & 7) << 3 | (k & 7) << 6);
    return areas[at] > 0.0f ? (uint)at + 1u : 0u;
}

// How far a coordinate is from the voxels from `at` to at + 1.
LW_FN float beyond(float x, int at) { return fmax(fmax((float)at - x, x - (float)(at + 1)), 0.0f); }

// Of the voxels around p's the nearest with a surface, the first of equals.
LW_FN uint nearest_key(const float* p, LwVoxelContents contents, __global const int* bricks,
                       __global const float* areas) {
    uint key = 0;
    float nearest = 4.0f;  // beyond all: two voxels squared
    for (int n = 0; n < 27; ++n) {
        const int i = (int)p[0] + n % 3 - 1, j = (int)p[1] + n / 3 % 3 - 1, k = (int)p[2] + n / 9 - 1;
        if (min(min(i, j), k) < 0 || max(max(i, j), k) >= contents.size) continue;
        const float dx = beyond(p[0], i), dy = beyond(p[1], j), dz = beyond(p[2], k);
        const float away = dx * dx + dy * dy + dz * dz;
        if (!(away < nearest)) continue;
        const uint found = voxel_key(i, j, k, contents, bricks, areas);
        if (found == 0) continue;
        key = found;
        nearest = away;
    }
    return key;
}

// Of a texel whose own voxel holds no surface.
LW_FN uint key_beside(const float* p, const float* n, LwVoxelContents contents,
                      __global const int* bricks, __global const float* areas) {
    const float most = (float)contents.size;
    for (int side = 0; side < 2; ++side) {
        const float nudge = side ? LIGHT_NUDGE : -LIGHT_NUDGE;
        const float x = p[0] + nudge * n[0], y = p[1] + nudge * n[1], z = p[2] + nudge * n[2];
        if (!is_in_grid(x, y, z, most)) continue;
        const uint key = voxel_key((int)x, (int)y, (int)z, contents, bricks, areas);
        if (key) return key;
    }
    return is_in_grid(p[0], p[1], p[2], most) ? nearest_key(p, contents, bricks, areas) : 0u;
}

// Texels of LW_WIDTH lanes: words of their records, key first; counts of those that found no voxel.
LW_FN void locate(__global const float* p, int stride, float4 origin, LwVoxelContents contents,
                  __global const int* bricks, __global const float* areas,
                  uint lanes[LW_LIGHT_RECORD][LW_WIDTH], int* outside, int* lost) {
    real flux[3], place[3];
    for (int c = 0; c < 3; ++c) flux[c] = load(p, (LW_RSM_FLUX + c) * stride);
    const mask lit =
        and_(fmax(fmax(flux[0], flux[1]), flux[2]) > 0.0f, splat_mask(origin.w > 0.0f ? 1 : 0));
    store((laneu)(0u), lanes[0], 0);
    if (!any_(lit)) return;
    const float corner[3] = {origin.x, origin.y, origin.z};
    mask inside = lit;
    for (int a = 0; a < 3; ++a) {
        place[a] = (load(p, (LW_RSM_POSITION + a) * stride) - corner[a]) * origin.w;
        inside = and_(inside, and_(place[a] >= 0.0f, place[a] < (float)contents.size));
    }
    const int side = contents.size / LW_VOXEL_BRICK;
    const lanei i = to_lanei(select_((real)(0.0f), place[0], inside)),
                j = to_lanei(select_((real)(0.0f), place[1], inside)),
                k = to_lanei(select_((real)(0.0f), place[2], inside));
    const lanei slot =
        gatheri(bricks, ((k >> (lanei)3) * side + (j >> (lanei)3)) * side + (i >> (lanei)3));
    const mask some = and_(inside, slot >= 0);
    const lanei inBrick = (i & (lanei)7) | (j & (lanei)7) << (lanei)3 | (k & (lanei)7) << (lanei)6;
    const lanei at = selecti_((lanei)(0), slot * LW_VOXEL_BRICK_VOXELS + inBrick, some);
    const mask found = and_(some, gather(areas, at) > 0.0f);
    store(as_laneu_(selecti_((lanei)(0), at + 1, found)), lanes[0], 0);
    for (int c = 0; c < 3; ++c) {
        store(as_laneu_(flux[c]), lanes[1 + c], 0);
        store(as_laneu_(load(p, (LW_RSM_NORMAL + c) * stride)), lanes[4 + c], 0);
    }
    uint rest = bits_(and_(lit, not_(found)));
    if (rest == 0) return;
    float x[LW_WIDTH], y[LW_WIDTH], z[LW_WIDTH];
    store(place[0], x, 0);
    store(place[1], y, 0);
    store(place[2], z, 0);
    while (rest) {
        const int l = take_lowest(&rest);
        const float q[3] = {x[l], y[l], z[l]},
                    n[3] = {as_float(lanes[4][l]), as_float(lanes[5][l]), as_float(lanes[6][l])};
        lanes[0][l] = key_beside(q, n, contents, bricks, areas);
        if (lanes[0][l]) continue;
        const int isInside = is_in_grid(q[0], q[1], q[2], (float)contents.size);
        *lost += isInside;
        *outside += !isInside;
    }
}

// The slot of a key's voxel holds other light now. marked: slots that this work-item has marked, each where
// its number's last bits say; atomics of single texels would take longer than all else.
LW_FN void mark_slot(uint key, int marked[LIGHT_MARKED], __global int* touched) {
    const int slot = (int)((key - 1u) / LW_VOXEL_BRICK_VOXELS), at = slot & (LIGHT_MARKED - 1);
    if (key == 0 || slot == marked[at]) return;
    marked[at] = slot;
    atomic_or(touched + slot, LW_LIGHT_TOUCHED);
}

// One work-item = LIGHT_RUN texels of all maps, rows of which are padded to 16. records: of the last
// frame's texels in, of this one's out.
__kernel void voxel_light_locate(__global const float* texels, int4 layout, int count,
                                 __global const LwGridPlace* grid, LwVoxelContents contents,
                                 __global const int* bricks, __global const float* surfaces,
                                 __global uint* records, __global int* touched,
                                 __global LwVoxelTexels* state) {
    const int first = lw_list_index() * LIGHT_RUN, last = min(first + LIGHT_RUN, count);
    const int stride = voxel_record(contents.planes);
    const float4 origin = grid->origin;
    __global const float* areas = surfaces + LW_SURFACE_AREA * contents.slots * LW_VOXEL_BRICK_VOXELS;
    uint lanes[LW_LIGHT_RECORD][LW_WIDTH];
    int outside = 0, lost = 0, changed = 0, marked[LIGHT_MARKED];
    for (int m = 0; m < LIGHT_MARKED; ++m) marked[m] = -1;
    store((laneu)(0u), lanes[LW_LIGHT_RECORD - 1], 0);
    for (int i = first; i < last; i += LW_WIDTH) {
        locate(texels + layout.x + i, layout.z, origin, contents, bricks, areas, lanes, &outside, &lost);
        for (int l = 0; l < LW_WIDTH; ++l) {
            __global uint* record = records + (i + l) * stride;
            const uint4 light = (uint4)(lanes[0][l], lanes[1][l], lanes[2][l], lanes[3][l]),
                        was = vload4(0, record);
            uint differs = light.x ^ was.x;
            if (light.x) differs |= (light.y ^ was.y) | (light.z ^ was.z) | (light.w ^ was.w);
            if (stride > 4) {
                const uint4 facing = (uint4)(lanes[4][l], lanes[5][l], lanes[6][l], 0u),
                            faced = vload4(1, record);
                if (light.x)
                    differs |= (facing.x ^ faced.x) | (facing.y ^ faced.y) | (facing.z ^ faced.z);
                if (differs && light.x) vstore4(facing, 1, record);
            }
            if (!differs) continue;
            changed = 1;
            mark_slot(was.x, marked, touched);
            mark_slot(light.x, marked, touched);
            if (light.x)
                vstore4(light, 0, record);
            else
                record[0] = 0u;
        }
    }
    if (changed) atomic_or(&state->changed, 1);
    if (outside) atomic_add(&state->outside, outside);
    if (lost) atomic_add(&state->lost, lost);
}

// One work-item = one of LW_LIGHT_ROWS runs of texels: those of bricks that are to be added up, in the
// order of these (a counting sort). ends: behind each slot's last texel in `order`.
__kernel void voxel_light_sort(__global const LwGridPlace* grid, LwVoxelContents contents, int count,
                               __global const uint* records, __global const int* touched,
                               __global const LwVoxelTexels* state, __global int* ends,
                               __global int* order) {
    const int row = lw_list_index();
    if (row >= LW_LIGHT_ROWS) return;
    const int all = state->first != grid->cell.y || state->second != grid->cell.z;
    if (!all && !state->changed) return;
    const int first = voxel_light_row(row, count), last = voxel_light_row(row + 1, count),
              stride = voxel_record(contents.planes);
    __global int* to = ends + row * contents.slots;
    for (int s = 0; s < contents.slots; ++s) to[s] = 0;
    for (int i = first; i < last; ++i) {
        const uint key = records[i * stride];
        if (key) ++to[(key - 1u) / LW_VOXEL_BRICK_VOXELS];
    }
    int sum = first;
    for (int s = 0; s < contents.slots; ++s) {
        const int begin = sum;
        if (all || touched[s] & LW_LIGHT_TOUCHED) sum += to[s];
        to[s] = begin;
    }
    for (int i = first; i < last; ++i) {
        const uint key = records[i * stride];
        if (key == 0) continue;
        const int slot = (int)((key - 1u) / LW_VOXEL_BRICK_VOXELS);
        if (all || touched[slot] & LW_LIGHT_TOUCHED) order[to[slot]++] = i;
    }
}
