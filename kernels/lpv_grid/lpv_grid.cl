// Where a light propagation volume lies, and the light that is injected into it (Kaplanyan and Dachsbacher 2010): every texel
// of the reflective shadow maps, and every VPL of the host's own, is a lobe of flux Phi in the cell half a cell in front of it,
// or surfaces would light themselves:
//   cell of x + n s / 2  +=  Phi / pi * lobe(n).
//
// Sums are whole numbers of 64 bits, so that nothing depends on the order of additions: a texel's light is cut to
// multiples of a power of two that the frame's brightest texel and the number of texels choose (LwLpvFit::bits), with which no
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

// Numbers that order as floats do, and back.
LW_FN uint key_of(float v) {
    const uint bits = as_uint(v);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
LW_FN float of_key(uint key) { return as_float(key & 0x80000000u ? key ^ 0x80000000u : ~key); }

LW_FN void raise(__global uint* to, uint value) { atomic_max(to, value); }

// One work-item = one row of an RSM: bounds of its surfaces, lit or not, and its largest flux.
__kernel void lpv_grid_scan_texels(__global const float* texels, int4 layout, __global const int4* rows, int rowCount,
                                   __global uint* state) {
    const int r = lw_list_index();
    if (r >= rowCount) return;
    const int4 row = rows[r];
    __global const float* base = texels + layout.x + row.x;
    const int stride = layout.z;
    real flux = (real)0.0f;
    real low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = (real)FLT_MAX;
        high[axis] = (real)-FLT_MAX;
    }
    for (int i = 0; i < row.y; i += LW_WIDTH) {
        const real nx = load(base, LW_RSM_NORMAL * stride + i), ny = load(base, (LW_RSM_NORMAL + 1) * stride + i),
                   nz = load(base, (LW_RSM_NORMAL + 2) * stride + i);
        const mask surface = and_(fma_(nx, nx, fma_(ny, ny, nz * nz)) > 0.0f, lanei_iota() + i < row.y);
        for (int axis = 0; axis < 3; ++axis) {
            const real x = load(base, (LW_RSM_POSITION + axis) * stride + i);
            low[axis] = select_(low[axis], fmin(low[axis], x), surface);
            high[axis] = select_(high[axis], fmax(high[axis], x), surface);
        }
        for (int c = 0; c < 3; ++c)
            flux = fmax(flux, select_((real)0.0f, load(base, (LW_RSM_FLUX + c) * stride + i), surface));
    }
    raise(state + LW_LPV_LARGEST, as_uint(max_lane(flux)));
    for (int axis = 0; axis < 3; ++axis) {
        const float least = min_lane(low[axis]), most = max_lane(high[axis]);
        if (!(least <= most)) continue;
        raise(state + LW_LPV_LOW + axis, key_of(-least));
        raise(state + LW_LPV_HIGH + axis, key_of(most));
    }
}

// One work-item = LPV_RUN VPLs, with flux or not.
__kernel void lpv_grid_scan_vpls(__global const lw_vpl* vpls, int count, __global uint* state) {
    const int first = lw_list_index() * LPV_RUN, last = min(first + LPV_RUN, count);
    float largest = 0.0f;
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (int i = first; i < last; ++i) {
        const lw_vpl vpl = vpls[i];
        const float flux = fmax(fmax(vpl.flux.x, vpl.flux.y), vpl.flux.z);
        if (!(flux > 0.0f)) continue;
        largest = fmax(largest, flux);
        const float p[3] = {vpl.positionArea.x, vpl.positionArea.y, vpl.positionArea.z};
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = fmin(low[axis], p[axis]);
            high[axis] = fmax(high[axis], p[axis]);
        }
    }
    if (!(largest > 0.0f)) return;
    raise(state + LW_LPV_LARGEST, as_uint(largest));
    for (int axis = 0; axis < 3; ++axis) {
        raise(state + LW_LPV_LOW + axis, key_of(-low[axis]));
        raise(state + LW_LPV_HIGH + axis, key_of(high[axis]));
    }
}

// Of the box that a grid is fitted to: a cell's share of a new grid beside the border of one cell all around, and how much
// smaller than the grid's inside the box may get before the grid shrinks. Less slack: the grid changes whenever a light moves,
// and all of the picture flickers. More: coarser cells.
#define LPV_SLACK 1.05f
#define LPV_LEAST 0.75f
// Sides of cells from which on their squares and the squares' inverses are finite.
#define LPV_LEAST_CELL 1e-18f
#define LPV_LARGEST_CELL 1e18f
// Cells from the world's origin to a place at most, so that no place is infinite.
#define LPV_MOST_CELLS 1e18f

// A grid about the box: the last one where it still fits, else that one moved by whole cells, else one of another size.
LW_FN LwLpvPlace fitted(LwLpvPlace last, LwLpvFit fit, const float* low, const float* high) {
    const float size = (float)fit.size;
    const float longest = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    const float inner = (size - 2.0f) * last.cell.x;
    const int keeps = !fit.refit && last.origin.w > 0.0f && longest <= inner && longest >= LPV_LEAST * inner;
    const float cell = keeps ? last.cell.x : longest * LPV_SLACK / (size - 2.0f);
    float origin[3] = {last.origin.x, last.origin.y, last.origin.z};
    for (int axis = 0; axis < 3; ++axis) {
        const float wanted = 0.5f * (low[axis] + high[axis]) - 0.5f * size * cell;
        if (!keeps)
            origin[axis] = wanted;
        else if (low[axis] < origin[axis] + cell || high[axis] > origin[axis] + (size - 1.0f) * cell)
            origin[axis] += cell * round((wanted - origin[axis]) / cell);
    }
    LwLpvPlace place;
    place.origin = (float4)(origin[0], origin[1], origin[2], 0.0f);
    place.cell = (float4)(cell, 1.0f, 1.0f, 0.0f);
    return place;
}

// Where the grid around a place begins, in cells from the world's origin: at whole ones, so that it stays where it is while the place
// moves within a cell, and all of its cells are cells of the world that light and blockers find again when it moves.
LW_FN float3 snapped(float3 centre, float cell, int size) {
    return clamp(floor(centre / cell), -LPV_MOST_CELLS, LPV_MOST_CELLS) - (float)(size / 2);
}

// One work-item in all: a grid of cells half as large around a place, or around the middle of the one that it lies in; between its
// border and the other's is a cell of the other at least, so that what lies in it lies in the other as well.
__kernel void lpv_grid_nest(__global const LwLpvPlace* outer, float4 focus, int size, __global LwLpvPlace* place) {
    if (get_global_id(0) != 0) return;
    LwLpvPlace to = *outer;
    const float cell = 0.5f * to.cell.x;
    if (to.origin.w > 0.0f && cell > LPV_LEAST_CELL) {
        const float3 middle = to.origin.xyz + to.cell.x * (float)(size / 2);
        const float3 corner = to.origin.xyz / cell;
        const float3 from = snapped(focus.w > 0.0f ? focus.xyz : middle, cell, size);
        to.origin.xyz = cell * clamp(from, ceil(corner) + 2.0f, floor(corner) + (float)(size - 2));
        to.origin.w = 1.0f / cell;
        to.cell.x = cell;
    } else {
        to.origin = (float4)(0.0f);
    }
    *place = to;
}

// One work-item in all.
__kernel void lpv_grid_fit(__global const uint* state, LwLpvFit fit, __global LwLpvPlace* place) {
    if (get_global_id(0) != 0) return;
    LwLpvPlace to = *place;
    if (fit.centre.w > 0.0f) {
        const float half_ = 0.5f * fit.centre.w;
        to.cell.x = fit.centre.w / (float)fit.size;
        to.origin = (float4)(fit.centre.x - half_, fit.centre.y - half_, fit.centre.z - half_, 0.0f);
        if (fit.snaps) to.origin.xyz = to.cell.x * snapped(fit.centre.xyz, to.cell.x, fit.size);
    } else {
        float low[3] = {fit.low.x, fit.low.y, fit.low.z}, high[3] = {fit.high.x, fit.high.y, fit.high.z};
        int some = fit.low.w > 0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            if (state[LW_LPV_HIGH + axis] == 0u) continue;
            const float least = -of_key(state[LW_LPV_LOW + axis]), most = of_key(state[LW_LPV_HIGH + axis]);
            low[axis] = fit.low.w > 0.0f ? fmin(low[axis], least) : least;
            high[axis] = fit.low.w > 0.0f ? fmax(high[axis], most) : most;
            some = 1;
        }
        if (some)
            to = fitted(to, fit, low, high);
        else if (fit.refit)
            to.cell.x = 0.0f;
    }
    const int usable = to.cell.x > LPV_LEAST_CELL && to.cell.x < LPV_LARGEST_CELL;
    if (!usable) to.origin = (float4)(0.0f);
    to.origin.w = usable ? 1.0f / to.cell.x : 0.0f;
    // The largest flux is below 2^exponent.
    int exponent = 0;
    const float largest = as_float(state[LW_LPV_LARGEST]);
    if (largest > 0.0f) frexp(largest, &exponent);
    const int shift = largest > 0.0f ? fit.bits - exponent : 0;
    to.cell.y = ldexp(1.0f, shift / 2);
    to.cell.z = ldexp(1.0f, shift - shift / 2);
    *place = to;
}

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
__kernel void lpv_grid_resolve(__global const uint* sums, __global const LwLpvPlace* grid, int size, float4 environment,
                               __global float* to) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const float first = 1.0f / grid->cell.y, second = 1.0f / grid->cell.z;
    __global const uint* from = sums + 2 * LW_LPV_PLANES * (line * size + x);
    const int at = lpv_cell(size, x, line % size, line / size), plane = lpv_plane(size);
    for (int p = 0; p < LW_LPV_PLANES; ++p) to[p * plane + at] = convert_float(long_at(from + 2 * p)) * first * second;
    const int y = line % size, z = line / size, last = size - 1;
    const float inX = (float)((x == 0) - (x == last)), inY = (float)((y == 0) - (y == last)), inZ = (float)((z == 0) - (z == last));
    const float faces = fabs(inX) + fabs(inY) + fabs(inZ);
    if (faces == 0.0f) return;
    // Of each band: how often the lobes have it.
    const float bands[LW_LPV_BANDS] = {LPV_LOBE0 * faces, LPV_LOBE1 * inX, LPV_LOBE1 * inY, LPV_LOBE1 * inZ};
    const float4 light = environment * (grid->cell.x * grid->cell.x);
    for (int band = 0; band < LW_LPV_BANDS; ++band) {
        to[band * plane + at] += bands[band] * light.x;
        to[(LW_LPV_BANDS + band) * plane + at] += bands[band] * light.y;
        to[(2 * LW_LPV_BANDS + band) * plane + at] += bands[band] * light.z;
    }
}
