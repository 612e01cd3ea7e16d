// Which voxels hold something, and where the eyes are that their light is swept from.
#include "shared/cluster_types.h"
#include "shared/grid_types.h"
#include "shared/vpl_list.h"
#include "shared/voxel_types.h"
#include "shared/voxel_visibility_types.h"
#include "shared/wide.h"

// Of a brick's 512 bits 16 words; a word holds 4 rows of 8 voxels.
#define LWV_WORDS (LW_VOXEL_BRICK_VOXELS / 32)

LW_FN uint solid_bytes(uint bits) {
    return ((bits & 1u) | (bits & 2u) << 7 | (bits & 4u) << 14 | (bits & 8u) << 21) * LW_SIGHT_SOLID;
}

// One work-item = one word of bits. held: those of the frame before (all new where `isNew`); solid: LW_SIGHT_SOLID for each
// voxel that holds something, in the order x, y, z.
__kernel void voxel_visibility_solid(__global const uint* occupied, int isNew, int size, __global uint* held,
                                     __global uint* solid, __global LwVoxelSight* sight) {
    const int word = lw_list_index();
    const int bricks = voxel_bricks(size, 0), brick = word / LWV_WORDS;
    if (brick >= bricks * bricks * bricks) return;
    const uint bits = occupied[word];
    if (!isNew && held[word] == bits) return;
    held[word] = bits;
    const int within = word % LWV_WORDS;
    const int x = brick % bricks * LW_VOXEL_BRICK, y = brick / bricks % bricks * LW_VOXEL_BRICK + (within & 1) * 4;
    const int z = brick / (bricks * bricks) * LW_VOXEL_BRICK + (within >> 1);
    for (int row = 0; row < 4; ++row) {
        const int first = (x + size * (y + row + size * z)) / 4;
        solid[first] = solid_bytes(bits >> (8 * row) & 15u);
        solid[first + 1] = solid_bytes(bits >> (8 * row + 4) & 15u);
    }
    atomic_or(&sight->changed, 1);
}

LW_FN bool is_in_grid(float4 p, float size) {
    return p.x >= 0.0f && p.y >= 0.0f && p.z >= 0.0f && p.x < size && p.y < size && p.z < size;
}

// Off its surface by one clearance, or by one and a half or two where something else holds that voxel.
LW_FN float4 eye_position(lw_cluster c, LwGridPlace place, int size, __global const uchar* solid) {
    float4 none = {0.0f, 0.0f, 0.0f, 0.0f}, first = none;
    if (c.position.w == 0.0f || place.origin.w == 0.0f) return none;
    const float clearance = sight_clearance(c.medoidNormal.x, c.medoidNormal.y, c.medoidNormal.z);
    for (int i = 2; i <= 4; ++i) {
        const float off = 0.5f * (float)i * clearance;
        float4 p = {(c.medoidPosition.x - place.origin.x) * place.origin.w + off * c.medoidNormal.x,
                    (c.medoidPosition.y - place.origin.y) * place.origin.w + off * c.medoidNormal.y,
                    (c.medoidPosition.z - place.origin.z) * place.origin.w + off * c.medoidNormal.z, 1.0f};
        if (!is_in_grid(p, (float)size)) return first;
        if (!solid[(int)p.x + size * ((int)p.y + size * (int)p.z)]) return p;
        if (i == 2) first = p;
    }
    return first;
}

// One work-item = one cluster, whose eye is number firstEye + its own. sight: the first of a frame's calls sets it up.
__kernel void voxel_visibility_eyes(__global const lw_cluster* clusters, int count, int firstEye, int isNew,
                                    __global const LwGridPlace* place, __global const uchar* solid,
                                    __global LwVoxelEye* eyes, __global LwVoxelSight* sight) {
    const int i = lw_list_index();
    if (i >= count) return;
    if (i == 0) sight->origin = place->origin;
    const float4 p = eye_position(clusters[i], *place, sight->size, solid);
    __global LwVoxelEye* eye = eyes + firstEye + i;
    const float4 last = eye->position;
    const bool moved = p.x != last.x || p.y != last.y || p.z != last.z || last.w != p.w;
    const bool sweep = p.w != 0.0f && (moved || isNew || sight->changed);
    eye->position = p;
    eye->sweep = (int4)(sweep ? 1 : 0, 0, 0, 0);
    if (sweep) atomic_inc(&sight->swept);
}
