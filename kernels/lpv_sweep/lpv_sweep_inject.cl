// What surfaces send, in the cells of a sweep's grid: each light into the cell half a cell in front of its surface, shared out
// among a set of normals (lpv_sweep_types.h): with spherical harmonics of three bands a lit plane would send 6 % of its radiance
// straight back, and 9 % along itself. Sums are whole numbers of 64 bits: the same bits in any order.
#include "shared/lpv_cells.h"
#include "shared/lpv_sweep_cells.h"
#include "shared/lpv_sweep_normal.h"
#include "shared/lpv_types.h"
#include "shared/rsm_types.h"
#include "shared/surfel_types.h"
#include "shared/vpl_list.h"
#include "shared/whole_sums.h"

// The light of one cell; bits of the normals that have some.
typedef struct {
    long sums[LW_SWEEP_SOURCES];
    int cell;
    uint bits;
} sweep_lights;

LW_FN void end_lights(sweep_lights* run, __global uint* sums, __global uint* marks) {
    if (run->bits) atomic_or(marks + run->cell, run->bits);
    __global uint* to = sums + 2 * LW_SWEEP_SOURCES * run->cell;
    while (run->bits) {
        const int k = LW_SWEEP_COLOURS * take_lowest(&run->bits);
        for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
            add_long(to + 2 * (k + c), run->sums[k + c]);
            run->sums[k + c] = 0;
        }
    }
}

LW_FN void no_lights(sweep_lights* run) {
    for (int i = 0; i < LW_SWEEP_SOURCES; ++i) run->sums[i] = 0;
    run->cell = -1;
    run->bits = 0u;
}

// 1 where no cell takes it.
LW_FN int add_light(sweep_lights* run, const LwLpvPlace place, int cell, const float* flux, float nx, float ny, float nz,
                    __global uint* sums, __global uint* marks) {
    if (cell != run->cell) {
        end_lights(run, sums, marks);
        run->cell = cell;
    }
    if (cell < 0) return 1;
    const sweep_normal n = normal_of(nx, ny, nz);
    // All of the flux, no more: the shares' sum is 1 to 1.128.
    const float scale = 1.0f / (n.shares[0] + n.shares[1] + n.shares[2]);
    for (int k = 0; k < 3; ++k) {
        if (!(n.shares[k] > 0.0f)) continue;
        run->bits |= 1u << n.bins[k];
        long* to = run->sums + LW_SWEEP_COLOURS * n.bins[k];
        for (int c = 0; c < LW_SWEEP_COLOURS; ++c) to[c] += whole(flux[c] * (n.shares[k] * scale), place);
    }
    return 0;
}

// One work-item = LW_SWEEP_RUN texels of all maps. Where there is an `inner` grid the lights in its cells are left out.
__kernel void lpv_sweep_inject_texels(__global const float* texels, int4 layout, int count, __global const LwLpvPlace* grid,
                                      __global const LwLpvPlace* innerGrid, int hasInner, int size, __global uint* sums,
                                      __global uint* outside) {
    const int first = lw_list_index() * LW_SWEEP_RUN, last = min(first + LW_SWEEP_RUN, count), stride = layout.z;
    const LwLpvPlace place = *grid, inner = *innerGrid;
    __global uint* marks = sums + sweep_light_marks(size);
    __global const float* base = texels + layout.x;
    sweep_lights run;
    no_lights(&run);
    int missed = 0;
    for (int i = first; i < last; ++i) {
        __global const float* p = base + i;
        const float flux[3] = {p[LW_RSM_FLUX * stride], p[(LW_RSM_FLUX + 1) * stride], p[(LW_RSM_FLUX + 2) * stride]};
        if (!(fmax(fmax(flux[0], flux[1]), flux[2]) > 0.0f)) continue;
        const float nx = p[LW_RSM_NORMAL * stride], ny = p[(LW_RSM_NORMAL + 1) * stride], nz = p[(LW_RSM_NORMAL + 2) * stride];
        const float px = p[LW_RSM_POSITION * stride], py = p[(LW_RSM_POSITION + 1) * stride], pz = p[(LW_RSM_POSITION + 2) * stride];
        if (hasInner && cell_of(inner, size, px, py, pz, nx, ny, nz, 0.5f) >= 0) continue;
        const int cell = cell_of(place, size, px, py, pz, nx, ny, nz, 0.5f);
        missed += add_light(&run, place, cell, flux, nx, ny, nz, sums, marks);
    }
    end_lights(&run, sums, marks);
    if (missed) atomic_add(outside, (uint)missed);
}

// One work-item = LW_SWEEP_RUN of the host's own VPLs.
__kernel void lpv_sweep_inject_vpls(__global const lw_vpl* vpls, int count, __global const LwLpvPlace* grid,
                                    __global const LwLpvPlace* innerGrid, int hasInner, int size, __global uint* sums,
                                    __global uint* outside) {
    const int first = lw_list_index() * LW_SWEEP_RUN, last = min(first + LW_SWEEP_RUN, count);
    const LwLpvPlace place = *grid, inner = *innerGrid;
    __global uint* marks = sums + sweep_light_marks(size);
    sweep_lights run;
    no_lights(&run);
    int missed = 0;
    for (int i = first; i < last; ++i) {
        const lw_vpl vpl = vpls[i];
        const float flux[3] = {vpl.flux.x, vpl.flux.y, vpl.flux.z};
        if (!(fmax(fmax(flux[0], flux[1]), flux[2]) > 0.0f)) continue;
        // Hosts' normals may be 2 % off unit length.
        const float scale = rsqrt(vpl.normal.x * vpl.normal.x + vpl.normal.y * vpl.normal.y + vpl.normal.z * vpl.normal.z);
        const float nx = vpl.normal.x * scale, ny = vpl.normal.y * scale, nz = vpl.normal.z * scale;
        const float px = vpl.positionArea.x, py = vpl.positionArea.y, pz = vpl.positionArea.z;
        if (hasInner && cell_of(inner, size, px, py, pz, nx, ny, nz, 0.5f) >= 0) continue;
        const int cell = cell_of(place, size, px, py, pz, nx, ny, nz, 0.5f);
        missed += add_light(&run, place, cell, flux, nx, ny, nz, sums, marks);
    }
    end_lights(&run, sums, marks);
    if (missed) atomic_add(outside, (uint)missed);
}

// ---------------------------------------------------------------------------- the next bounce's light

// One work-item in all: the place as it is, with the unit of the next bounce's whole numbers. largest: of what arrives at a
// cell's side, whose surfels send no more than LW_SWEEP_MOST_AREA sides of that.
__kernel void lpv_sweep_unit(__global const LwLpvPlace* grid, __global const uint* largest, int bits, __global LwLpvPlace* to) {
    if (get_global_id(0) != 0) return;
    LwLpvPlace place = *grid;
    const float most = as_float(*largest);
    int shift = 0;
    if (most > 0.0f && place.cell.x > 0.0f) {
        int light, side;
        frexp(most, &light);
        frexp(place.cell.x, &side);
        shift = bits - (light + 4 + 2 * side);
    }
    place.cell.y = ldexp(1.0f, shift / 2);
    place.cell.z = ldexp(1.0f, shift - shift / 2);
    *to = place;
}

// One work-item = LW_SWEEP_RUN surfels: what they send of what arrives at them.
__kernel void lpv_sweep_relight(__global const float* surfels, int stride, int count, __global const LwLpvPlace* grid,
                                __global const LwLpvPlace* innerGrid, int hasInner, int size, __global const float16* cells,
                                __global uint* sums) {
    const int first = lw_list_index() * LW_SWEEP_RUN, last = min(first + LW_SWEEP_RUN, count);
    const LwLpvPlace place = *grid, inner = *innerGrid;
    const float inverse = place.origin.w, most = LW_SWEEP_MOST_AREA * place.cell.x * place.cell.x;
    if (!(inverse > 0.0f)) return;
    __global uint* marks = sums + sweep_light_marks(size);
    sweep_lights run;
    no_lights(&run);
    for (int i = first; i < last; ++i) {
        __global const float* p = surfels + i;
        const float radius = p[LW_SURFEL_RADIUS * stride];
        if (!(radius > 0.0f)) continue;
        const float px = p[LW_SURFEL_POSITION * stride], py = p[(LW_SURFEL_POSITION + 1) * stride],
                    pz = p[(LW_SURFEL_POSITION + 2) * stride], nx = p[LW_SURFEL_NORMAL * stride],
                    ny = p[(LW_SURFEL_NORMAL + 1) * stride], nz = p[(LW_SURFEL_NORMAL + 2) * stride];
        const int cell = cell_of(place, size, px, py, pz, nx, ny, nz, 0.5f);
        if (cell < 0 || (hasInner && cell_of(inner, size, px, py, pz, nx, ny, nz, 0.5f) >= 0)) continue;
        const float4 e = sweep_read_twice(cells, size, (px - place.origin.x) * inverse, (py - place.origin.y) * inverse,
                                          (pz - place.origin.z) * inverse, nx, ny, nz);
        const float area = fmin(M_PI_F * radius * radius, most) * (1.0f / 1023.0f);
        const uint albedo = as_uint(p[LW_SURFEL_ALBEDO * stride]);
        const float flux[3] = {e.x * area * (float)(albedo & 1023u), e.y * area * (float)(albedo >> 10 & 1023u),
                               e.z * area * (float)(albedo >> 20 & 1023u)};
        add_light(&run, place, cell, flux, nx, ny, nz, sums, marks);
    }
    end_lights(&run, sums, marks);
}
