// Irradiance from a few VPLs, resampled per pixel (Talbot et al. 2005; with one reservoir for each, Bitterli et al. 2020).
//
// The candidates of a pixel's tile are cut into `survivors` runs. Of each run a pixel keeps one, drawn in proportion to the
// luminance that it would bring with nothing in between over its source density, and looks up the visibility of that one's
// cluster only. The run's sum stands for the ones left out: unbiased, as each run is resampled for itself.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4, 8
#endif
#include "clustered_gather/clustered_visibility.h"
#include "resampling_numbers.h"
#include "shared/spread_number.h"
#include "shared/vpl_light.h"
#include "shared/vpl_resampling_types.h"
#include "shared/vpl_tiles.h"

// sums[i]: luminance that candidates 0 .. i bring together.
LW_FN void weigh_run(real* sums, const lw_surface away, __global const float* vpls, __global const lw_vpl_draw* run, int count) {
    real sum = (real)0.0f;
    for (int i = 0; i < count; i += 2) {
        const int other = min(i + 1, count - 1);
        __global const float* const vpl[2] = {vpls + 12 * run[i].slot, vpls + 12 * run[other].slot};
        real w[2];
        weigh_two_vpls(w, away, vpl);
        sum = fma_(w[0], luminance(vpl[0][8], vpl[0][9], vpl[0][10]) * run[i].weight, sum);
        sums[i] = sum;
        if (other > i) {
            sum = fma_(w[1], luminance(vpl[1][8], vpl[1][9], vpl[1][10]) * run[other].weight, sum);
            sums[other] = sum;
        }
    }
}

// The light of one run: lane by lane that of the candidate where the sums pass the share `u` of the whole.
LW_FN void add_run(rgb* e, const lw_surface s, const lw_surface away, __global const float* vpls,
                   __global const lw_vpl_draw* run, int count, real u, lw_maps maps) {
    real sums[LW_MOST_CANDIDATES];
    weigh_run(sums, away, vpls, run, count);
    const real whole = sums[count - 1], target = u * whole;
    rgb colour = {(real)0.0f, (real)0.0f, (real)0.0f};
    real cluster = (real)-1.0f;
    for (int i = count - 1; i >= 0; --i) {
        __global const float* const vpl = vpls + 12 * run[i].slot;
        const float flux = luminance(vpl[8], vpl[9], vpl[10]), scale = flux > 0.0f ? 1.0f / flux : 0.0f;
        const mask taken = target < sums[i];
        colour.r = select_(colour.r, (real)(vpl[8] * scale), taken);
        colour.g = select_(colour.g, (real)(vpl[9] * scale), taken);
        colour.b = select_(colour.b, (real)(vpl[10] * scale), taken);
        cluster = select_(cluster, (real)vpl[11], taken);
    }
    real light = select_((real)0.0f, whole, s.valid);
    float last = -1.0f;
    for (int i = 0; i < count; ++i) {
        const float of = vpls[12 * run[i].slot + 11];
        if (of == last) continue;
        last = of;
        const mask looks = and_(cluster == of, light > 0.0f);
        if (!any_(looks)) continue;
        light = select_(light, light * cluster_visibility(maps, (int)of, s), looks);
    }
    e->r = fma_(light, colour.r, e->r);
    e->g = fma_(light, colour.g, e->g);
    e->b = fma_(light, colour.b, e->b);
}

// One work-item = LW_WIDTH * LW_INTERLEAVE adjacent pixels of one row, of a width x height image.
// vpls: float[12] each as clustered_gather_order wrote them, in one subset. list: as vpl_resampling_draw left it. frames ...
// irradiance, counts: as in clustered_gather_gather.
__kernel void vpl_resampling_gather(__global const float* position, int4 positionLayout, __global const float* normal,
                                    int4 normalLayout, int width, int height, __global const float* vpls,
                                    lw_vpl_draws draws, __global const lw_vpl_draw* list, lw_vpl_tiles tiles,
                                    __global const lw_paraboloid* frames, __global const float* records,
                                    __global const lw_paraboloid* secondFrames, __global const float* secondRecords,
                                    int seconds, int size, __global const uchar* sights, __global const LwVoxelEye* eyes,
                                    __global const LwVoxelSight* sight, __global float* irradiance, int4 irradianceLayout,
                                    __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH * LW_INTERLEAVE, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int tile = (y / LW_TILE_ROWS) * tiles.columns + x / tiles.tileWidth;
    const int positionRow = positionLayout.x + y * positionLayout.y, normalRow = normalLayout.x + y * normalLayout.y;
    const lw_maps maps = {frames, records, secondFrames, secondRecords, seconds, size, sights, eyes, sight};
    real p[3][LW_INTERLEAVE], n[3][LW_INTERLEAVE], e[3][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_dealt(p[a], position, positionRow + a * positionLayout.z, x, width);
        load_dealt(n[a], normal, normalRow + a * normalLayout.z, x, width);
    }
    list += tile * (LW_INTERLEAVE * LW_INTERLEAVE * draws.candidates);
    // Pixels of a window share their random number but for an even shift.
    const laneu window = as_laneu_(lanei_iota() + x / LW_INTERLEAVE) + (uint)(y / LW_INTERLEAVE) * 0x10001u;

    lanei rejectedHere = (lanei)0, saturatedHere = (lanei)0;
    for (int j = 0; j < LW_INTERLEAVE; ++j) {  // not unrolled: seconds of compilation
        const lw_surface s = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        rgb sum = {(real)0.0f, (real)0.0f, (real)0.0f};
        if (any_(s.valid)) {
            const int number = spread_number((y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + j, LW_INTERLEAVE);
            const lw_surface away = turned_away(s);
            __global const lw_vpl_draw* const own = list + number * draws.candidates;
            for (int k = 0; k < draws.survivors; ++k) {
                const int from = draws.candidates * k / draws.survivors, to = draws.candidates * (k + 1) / draws.survivors;
                const laneu h = lanes_hash(window, draws.key ^ ((uint)(k + 1) * 0x9e3779b9u));
                const uint shift = (uint)number * (0xffffffffu / (LW_INTERLEAVE * LW_INTERLEAVE) + 1u);
                add_run(&sum, s, away, vpls, own + from, to - from, unit_lanes(h + shift), maps);
            }
        }
        const mask saturated = finish_irradiance(sum, s.valid, &e[0][j], &e[1][j], &e[2][j]);
        rejectedHere += selecti_((lanei)0, (lanei)1, s.rejected);
        saturatedHere += selecti_((lanei)0, (lanei)1, saturated);
    }
    LW_UNROLL for (int a = 0; a < 3; ++a)
        store_dealt(e[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
    if (any_(to_mask(rejectedHere))) atomic_add(counts, sum_(rejectedHere));
    if (any_(to_mask(saturatedHere))) atomic_add(counts + 2, sum_(saturatedHere));
}
