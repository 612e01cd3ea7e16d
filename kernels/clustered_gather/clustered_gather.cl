// The interleaved gather with visibility by clusters (Dong et al. 2009; Aranha et al. 2020): a VPL lights a pixel as
// far as its cluster's paraboloid map sees the pixel. VPLs come sorted by cluster, so that each pixel looks up
// a cluster once.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4, 8
#endif
#include "clustered_visibility.h"
#include "shared/doubtful_light.h"
#include "shared/vpl_light.h"
#include "shared/vpl_tiles.h"

// The clusters of the first and of the last VPL among those of `bits` are looked up together: a look-up is one long chain of
// dependent operations, and two such take little longer than one.
LW_FN lw_current look_ahead(uint bits, __global const float* vpls, lw_maps maps, const lw_surface s) {
    lw_current current = no_cluster();
    if (!bits) return current;
    current.cluster = vpls[12 * (int)popcount(~bits & (bits - 1u)) + 11];
    current.last = vpls[12 * (31 - (int)clz(bits)) + 11];
    current.seen = cluster_visibility(maps, (int)current.cluster, s, &current.doubt);
    current.lastSeen = current.seen;
    current.lastDoubt = current.doubt;
    if (current.last != current.cluster) current.lastSeen = cluster_visibility(maps, (int)current.last, s, &current.lastDoubt);
    current.isDoubtful = some_doubt(current.doubt);
    return current;
}

// Light as far as it is seen; once there is unshadowed light, what came before it; what is doubtful, a sum over the channels.
typedef struct {
    rgb light, shadowed;
    real doubt;
    int isUnshadowed;  // some of it
} lw_seen_light;

LW_FN lw_seen_light no_light(void) {
    const lw_seen_light none = {{(real)0.0f, (real)0.0f, (real)0.0f}, {(real)0.0f, (real)0.0f, (real)0.0f}, (real)0.0f, 0};
    return none;
}

LW_FN real channel_sum(rgb light) { return light.r + light.g + light.b; }

// VPLs that nothing shadows come after all others.
LW_FN void note_unshadowed(lw_seen_light* e, const lw_current* current) {
    if (LW_VISIBILITY != 4 || current->cluster != LW_UNSHADOWED || e->isUnshadowed) return;
    e->shadowed = e->light;
    e->isUnshadowed = 1;
}

LW_FN void add_two_seen(lw_seen_light* e, const lw_surface s, const lw_surface away, __global const float* first,
                        __global const float* second, lw_maps maps, lw_current* current) {
    __global const float* const vpl[2] = {first, second};
    real w[2];
    weigh_two_vpls(w, away, vpl);
    LW_UNROLL for (int u = 0; u < 2; ++u) {
        const real seen = visibility_of(current, maps, vpl[u], s);
        note_unshadowed(e, current);
        add_light(&e->light, w[u] * seen, vpl[u]);
        if (current->isDoubtful) e->doubt = fma_(w[u] * current->doubt, vpl[u][8] + vpl[u][9] + vpl[u][10], e->doubt);
    }
}

// All VPLs of a subset that the tile has not skipped, in the order of their slots.
LW_FN lw_seen_light gather_subset(const lw_surface s, __global const float* vpls, lw_subset_order order, int subset,
                        __global const uint* masks, lw_vpl_tiles tiles, int tile, lw_maps maps,
                        uint shadowed) {
    lw_seen_light e = no_light();
    const lw_surface away = turned_away(s);
    lw_current current = no_cluster();
    vpls += 12 * subset * order.capacity;
    if (tiles.words == 0) {
        for (int k = 0; k < order.capacity; k += 2)
            add_two_seen(&e, s, away, vpls + 12 * k, vpls + 12 * k + 12, maps, &current);
        return e;
    }
    current = look_ahead(masks[subset * tiles.words * lw_tile_stride(tiles) + tile] & shadowed, vpls, maps, s);
    for (int word = 0; word < tiles.words; ++word, vpls += 12 * 32) {
        uint bits = masks[(subset * tiles.words + word) * lw_tile_stride(tiles) + tile];
        while (bits) {
            const int first = take_lowest(&bits), second = take_lowest(&bits);
            add_two_seen(&e, s, away, vpls + 12 * first, vpls + 12 * second, maps, &current);
        }
    }
    return e;
}

// Of unshadowed light what the rest bears out, at least a quarter.
LW_FN void bear_unshadowed_out(lw_seen_light* e) {
    if (!e->isUnshadowed) return;
    const real share = unshadowed_share(channel_sum(e->shadowed), channel_sum(e->light));
    e->light.r = borne_part(e->shadowed.r, e->light.r, share);
    e->light.g = borne_part(e->shadowed.g, e->light.g, share);
    e->light.b = borne_part(e->shadowed.b, e->light.b, share);
}

// What of the finished light r, g, b is doubtful, as its sum over the channels; unless that is to be kept, what is not borne out goes.
LW_FN real settle_doubt(real* r, real* g, real* b, const lw_seen_light sum, int isKept) {
    const real all = channel_sum(sum.light), finished = *r + *g + *b;
    if (isKept) return select_((real)0.0f, finished * fmin(sum.doubt / all, (real)1.0f), and_(all > 0.0f, all < INFINITY));
    const real share = borne_out(all, sum.doubt);
    *r *= share;
    *g *= share;
    *b *= share;
    return (real)0.0f;
}

// One work-item = LW_WIDTH * LW_INTERLEAVE adjacent pixels of one row, of a width x height image.
// vpls: float[12] each as clustered_gather_order and _deal wrote them. frames1 ... sight: as lw_maps. masks, irradiance, counts: as in interleaved_gather_gather.
// Of strict look-ups: withDoubt: a fourth plane of `irradiance` takes what is doubtful, for a filter that knows more of a place's light than
// one pixel's subset tells; otherwise each pixel decides by its own. About unshadowed light each pixel decides at once.
__kernel void clustered_gather_gather(__global const float* position, int4 positionLayout,
                                      __global const float* normal, int4 normalLayout, int width, int height,
                                      __global const float* vpls, lw_subset_order order,
                                      __global const uint* masks, lw_vpl_tiles tiles,
                                      LW_MAPS_ARGUMENTS, uint shadowed, int withDoubt,
                                      __global float* irradiance, int4 irradianceLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH * LW_INTERLEAVE, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int tile = (y / LW_TILE_ROWS) * tiles.columns + x / tiles.tileWidth;
    const int positionRow = positionLayout.x + y * positionLayout.y, normalRow = normalLayout.x + y * normalLayout.y;
    const lw_maps maps = LW_MAPS_OF_ARGUMENTS;
    real p[3][LW_INTERLEAVE], n[3][LW_INTERLEAVE], e[4][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_dealt(p[a], position, positionRow + a * positionLayout.z, x, width);
        load_dealt(n[a], normal, normalRow + a * normalLayout.z, x, width);
        expect_dealt(position, positionRow + a * positionLayout.z, x);
        expect_dealt(normal, normalRow + a * normalLayout.z, x);
    }

    lanei rejectedHere = (lanei)0, saturatedHere = (lanei)0;
    for (int j = 0; j < LW_INTERLEAVE; ++j) {  // not unrolled: seconds of compilation
        const lw_surface s = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        lw_seen_light sum = no_light();
        if (any_(s.valid)) {
            const int subset = (y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + j;
            sum = gather_subset(s, vpls, order, subset, masks, tiles, tile, maps, shadowed);
            if (LW_VISIBILITY == 4) bear_unshadowed_out(&sum);
        }
        const mask saturated = finish_irradiance(sum.light, s.valid, &e[0][j], &e[1][j], &e[2][j]);
        if (LW_VISIBILITY == 4) e[3][j] = settle_doubt(e[0] + j, e[1] + j, e[2] + j, sum, withDoubt);
        rejectedHere += selecti_((lanei)0, (lanei)1, s.rejected);
        saturatedHere += selecti_((lanei)0, (lanei)1, saturated);
    }
    LW_UNROLL for (int a = 0; a < 3; ++a)
        store_dealt(e[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
    if (LW_VISIBILITY == 4 && withDoubt)
        store_dealt(e[3], irradiance, irradianceLayout.x + 3 * irradianceLayout.z + y * irradianceLayout.y, x, width);
    if (any_(to_mask(rejectedHere))) atomic_add(counts, sum_(rejectedHere));
    if (any_(to_mask(saturatedHere))) atomic_add(counts + 2, sum_(saturatedHere));
}

// For debugging: one work-item = LW_WIDTH pixels (x) of one cluster's row (y): how far the gather takes the surface to be
// seen by the cluster, beyond doubt; the clusters one below the other; 0 without a surface.
__kernel void clustered_gather_visibility(__global const float* position, int4 positionLayout,
                                          __global const float* normal, int4 normalLayout, int width, int height,
                                          int clusters, LW_MAPS_ARGUMENTS, __global float* planes, int rowStride) {
    const int x = (int)get_global_id(0) * LW_WIDTH, row = (int)get_global_id(1);
    if (x >= width || row >= clusters * height) return;
    const int cluster = row / height;
    const lw_maps maps = LW_MAPS_OF_ARGUMENTS;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, row - cluster * height);
    real doubt;
    const real seen = cluster_visibility(maps, cluster, s, &doubt);
    store(select_((real)0.0f, seen - doubt, s.valid), planes, row * rowStride + x);
}
