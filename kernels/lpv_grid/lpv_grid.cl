// The light that is injected into a light propagation volume (Kaplanyan and Dachsbacher 2010): every texel of the reflective shadow maps, and every VPL of the host's own, is a lobe of flux Phi in the cell half a cell in front of it,
// or surfaces would light themselves:
//   cell of x + n s / 2  +=  Phi / pi * lobe(n).
//
// Sums are whole numbers of 64 bits, so that nothing depends on the order of additions: a texel's light is cut to
// multiples of a power of two that the frame's brightest texel and the number of texels choose (LwGridFit::bits), with which no
// sum can overflow. Of n texels the unit is at most 2^-60 n of the brightest one, the error of a sum n units.
#include "shared/lpv_cells.h"
#include "shared/lpv_types.h"
#include "shared/rsm_types.h"
#include "shared/vpl_list.h"
#include "shared/whole_sums.h"
#include "shared/wide.h"

#define LPV_LOBE0_PI 0.2820947918f  // LOBE0 / pi
#define LPV_LOBE1_PI 0.3257350079f  // LOBE1 / pi
#define LPV_LOBE0 0.8862269255f
#define LPV_LOBE1 1.0233267079f
// Texels or VPLs of a work-item, which adds up those of one cell before it touches memory that others write as well.
#define LPV_RUN 64

// Sums of one cell's lights; of cell -1 what lies outside.
typedef struct {
    long sums[LW_LPV_PLANES];
    int cell;
} lpv_run;

LW_FN void end_run(lpv_run* run, __global uint* sums) {
    if (run->cell < 0) return;
    __global uint* to = sums + 2 * LW_LPV_PLANES * run->cell;
    for (int c = 0; c < LW_LPV_PLANES; ++c) {
        add_long(to + 2 * c, run->sums[c]);
        run->sums[c] = 0;
    }
}

LW_FN int add_light(lpv_run* run, const LwLpvPlace place, int cell, const float* flux, float nx, float ny, float nz,
                    __global uint* sums) {
    if (cell != run->cell) {
        end_run(run, sums);
        run->cell = cell;
    }
    if (cell < 0) return 1;
    _Pragma("unroll") for (int c = 0; c < LW_LPV_COLOURS; ++c) {
        const float lobe0 = flux[c] * LPV_LOBE0_PI, lobe1 = flux[c] * LPV_LOBE1_PI;
        long* to = run->sums + LW_LPV_BANDS * c;
        to[0] += whole(lobe0, place);
        to[1] += whole(lobe1 * nx, place);
        to[2] += whole(lobe1 * ny, place);
        to[3] += whole(lobe1 * nz, place);
    }
    return 0;
}

LW_FN lpv_run empty_run(void) {
    lpv_run run;
    for (int c = 0; c < LW_LPV_PLANES; ++c) run.sums[c] = 0;
    run.cell = -1;
    return run;
}

// One work-item = LPV_RUN texels of all maps. sums: two halves of 64 bits for each of a cell's planes. Where there is an `inner`
// grid the lights in its cells are left out, and those that no cell takes not counted.
__kernel void lpv_grid_inject_texels(__global const float* texels, int4 layout, int count, __global const LwLpvPlace* grid,
                                     __global const LwLpvPlace* innerGrid, int hasInner, int size, __global uint* sums,
                                     __global uint* state) {
    const int first = lw_list_index() * LPV_RUN, last = min(first + LPV_RUN, count), stride = layout.z;
    const LwLpvPlace place = *grid, inner = *innerGrid;
    __global const float* base = texels + layout.x;
    lpv_run run = empty_run();
    int outside = 0;
    for (int i = first; i < last; ++i) {
        __global const float* p = base + i;
        const float flux[3] = {p[LW_RSM_FLUX * stride], p[(LW_RSM_FLUX + 1) * stride], p[(LW_RSM_FLUX + 2) * stride]};
        if (!(fmax(fmax(flux[0], flux[1]), flux[2]) > 0.0f)) continue;
        const float nx = p[LW_RSM_NORMAL * stride], ny = p[(LW_RSM_NORMAL + 1) * stride], nz = p[(LW_RSM_NORMAL + 2) * stride];
        const float px = p[LW_RSM_POSITION * stride], py = p[(LW_RSM_POSITION + 1) * stride], pz = p[(LW_RSM_POSITION + 2) * stride];
        if (hasInner && cell_of(inner, size, px, py, pz, nx, ny, nz, 0.5f) >= 0) continue;
        const int cell = cell_of(place, size, px, py, pz, nx, ny, nz, 0.5f);
        outside += add_light(&run, place, cell, flux, nx, ny, nz, sums);
    }
    end_run(&run, sums);
    if (outside && !hasInner) atomic_add(state + LW_LPV_OUTSIDE, (uint)outside);
}

// One work-item = LPV_RUN of the host's own VPLs.
__kernel void lpv_grid_inject_vpls(__global const lw_vpl* vpls, int count, __global const LwLpvPlace* grid,
                                   __global const LwLpvPlace* innerGrid, int hasInner, int size, __global uint* sums,
                                   __global uint* state) {
    const int first = lw_list_index() * LPV_RUN, last = min(first + LPV_RUN, count);
    const LwLpvPlace place = *grid, inner = *innerGrid;
    lpv_run run = empty_run();
    int outside = 0;
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
        outside += add_light(&run, place, cell, flux, nx, ny, nz, sums);
    }
    end_run(&run, sums);
    if (outside && !hasInner) atomic_add(state + LW_LPV_OUTSIDE, (uint)outside);
}

// One work-item = one cell (x; y and z): its sums as floats, in W/sr.
//
// environment: radiance that comes from outside, of each colour. Through each outer face of the border's cells its flux, pi L s^2,
// enters as a lobe about the inward normal, as propagation would hand it on from a cell beyond: L s^2 lobe(n).
//
// changed: raised where a cell's light is another than it was; watches: 0: it is not touched.
__kernel void lpv_grid_resolve(__global const uint* sums, __global const LwLpvPlace* grid, int size, float4 environment,
                               __global float* to, int watches, __global int* changed) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const float first = 1.0f / grid->cell.y, second = 1.0f / grid->cell.z;
    __global const uint* from = sums + 2 * LW_LPV_PLANES * (line * size + x);
    const int at = lpv_cell(size, x, line % size, line / size), plane = lpv_plane(size);
    float light[LW_LPV_PLANES];
    for (int p = 0; p < LW_LPV_PLANES; ++p) light[p] = convert_float(long_at(from + 2 * p)) * first * second;
    const int y = line % size, z = line / size, last = size - 1;
    const float inX = (float)((x == 0) - (x == last)), inY = (float)((y == 0) - (y == last)), inZ = (float)((z == 0) - (z == last));
    const float faces = fabs(inX) + fabs(inY) + fabs(inZ);
    // Of each band: how often the lobes have it.
    const float bands[LW_LPV_BANDS] = {LPV_LOBE0 * faces, LPV_LOBE1 * inX, LPV_LOBE1 * inY, LPV_LOBE1 * inZ};
    const float4 sky = environment * (grid->cell.x * grid->cell.x);
    for (int band = 0; faces != 0.0f && band < LW_LPV_BANDS; ++band) {
        light[band] += bands[band] * sky.x;
        light[LW_LPV_BANDS + band] += bands[band] * sky.y;
        light[2 * LW_LPV_BANDS + band] += bands[band] * sky.z;
    }
    int isOther = 0;
    for (int p = 0; p < LW_LPV_PLANES; ++p) {
        isOther |= watches && to[p * plane + at] != light[p];
        to[p * plane + at] = light[p];
    }
    if (isOther) atomic_or(changed, 1);
}
