// The light of clustered VPLs at points, in two bands of spherical harmonics, with the visibility of each cluster's map: what
// clustered_gather_gather takes, before a surface's cosine is known. A point without a normal is seen as far as nothing lies
// before it.
#include "clustered_visibility.h"
#include "shared/doubtful_light.h"
#include "shared/subset_order.h"
#include "shared/vpl_bands.h"

// What surfaces that face each VPL get, over the channels.
LW_FN real facing_sum(lw_bands sum) { return sum.c[0][0] + sum.c[0][1] + sum.c[0][2]; }

LW_FN void keep_borne_bands(lw_bands* sum, lw_bands shadowed, real share) {
    LW_UNROLL for (int b = 0; b < 4; ++b)
        LW_UNROLL for (int c = 0; c < 3; ++c) sum->c[b][c] = borne_part(shadowed.c[b][c], sum->c[b][c], share);
}

// One work-item = LW_WIDTH points of a row, of a width x height image of them. vpls: float[12] each, order.capacity (even) of them,
// sorted by cluster. frames1 ... sight: as lw_maps. harmonics, counts: as in interleaved_gather_harmonics.
__kernel void clustered_gather_harmonics(__global const float* position, int4 positionLayout, __global const float* normal,
                                         int4 normalLayout, int hasNormals, int width, int height,
                                         __global const float* vpls, lw_subset_order order,
                                         LW_MAPS_ARGUMENTS,
                                         __global float* harmonics, int4 harmonicsLayout, int band,
                                         __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_maps maps = LW_MAPS_OF_ARGUMENTS;
    const lw_surface s = load_point(position, positionLayout, normal, normalLayout, hasNormals, x, y);
    lw_bands sum = no_bands(), shadowed = no_bands();
    if (any_(s.valid)) {
        lw_current current = no_cluster();
        real doubt = (real)0.0f;  // of what a surface that faces each VPL gets, over the channels
        int isUnshadowed = 0;     // some of it; what came before it is all that is shadowed
        for (int k = 0; k < order.capacity; k += 2) {
            __global const float* const vpl[2] = {vpls + 12 * k, vpls + 12 * k + 12};
            real facing[2], from[2][3];
            reach_two_points(facing, from, s, vpl);
            LW_UNROLL for (int u = 0; u < 2; ++u) {
                const real seen = visibility_of(&current, maps, vpl[u], s);
                if (LW_VISIBILITY == 4 && current.cluster == LW_UNSHADOWED && !isUnshadowed) {
                    shadowed = sum;
                    isUnshadowed = 1;
                }
                add_bands(&sum, facing[u], from[u], seen, vpl[u]);
                if (current.isDoubtful) doubt = fma_(facing[u] * current.doubt, vpl[u][8] + vpl[u][9] + vpl[u][10], doubt);
            }
        }
        if (isUnshadowed) keep_borne_bands(&sum, shadowed, unshadowed_share(facing_sum(shadowed), facing_sum(sum)));
        if (LW_VISIBILITY == 4) scale_bands(&sum, borne_out(facing_sum(sum), doubt));
    }
    const mask saturated = store_bands(finish_bands(sum), s.valid, harmonics, harmonicsLayout, band, x, y);
    const mask counted = and_(saturated, lanei_iota() + x < width);
    if (any_(counted)) atomic_add(counts + 2, count_(counted));
}
