// Where a grid of cubic cells lies: around a place, or fitted to what the reflective shadow maps and the host's VPLs and box fill;
// and the unit in which the frame's light is counted in whole numbers.
#include "shared/grid_types.h"
#include "shared/rsm_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

// VPLs of a work-item.
#define GRID_RUN 64

// Numbers that order as floats do, and back.
LW_FN uint key_of(float v) {
    const uint bits = as_uint(v);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
LW_FN float of_key(uint key) { return as_float(key & 0x80000000u ? key ^ 0x80000000u : ~key); }

LW_FN void raise(__global uint* to, uint value) { atomic_max(to, value); }

// One work-item = one row of an RSM: bounds of its surfaces, lit or not, and its largest flux.
__kernel void grid_place_scan_texels(__global const float* texels, int4 layout, __global const int4* rows, int rowCount,
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
    raise(state + LW_GRID_LARGEST, as_uint(max_lane(flux)));
    for (int axis = 0; axis < 3; ++axis) {
        const float least = min_lane(low[axis]), most = max_lane(high[axis]);
        if (!(least <= most)) continue;
        raise(state + LW_GRID_LOW + axis, key_of(-least));
        raise(state + LW_GRID_HIGH + axis, key_of(most));
    }
}

// One work-item = GRID_RUN VPLs, with flux or not.
__kernel void grid_place_scan_vpls(__global const lw_vpl* vpls, int count, __global uint* state) {
    const int first = lw_list_index() * GRID_RUN, last = min(first + GRID_RUN, count);
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
    raise(state + LW_GRID_LARGEST, as_uint(largest));
    for (int axis = 0; axis < 3; ++axis) {
        raise(state + LW_GRID_LOW + axis, key_of(-low[axis]));
        raise(state + LW_GRID_HIGH + axis, key_of(high[axis]));
    }
}

// Of the box that a grid is fitted to: a cell's share of a new grid beside the border of one cell all around, and how much
// smaller than the grid's inside the box may get before the grid shrinks. Less slack: the grid changes whenever a light moves,
// and all of the picture flickers. More: coarser cells.
#define GRID_SLACK 1.05f
#define GRID_LEAST 0.75f
// Sides of cells from which on their squares and the squares' inverses are finite.
#define GRID_LEAST_CELL 1e-18f
#define GRID_LARGEST_CELL 1e18f
// Of a run of cells, how far off its border a corner lies on it: that of a grid around is often on one, but for rounding, and a run more
// or less moves all of the grid within. More: grids come nearer to the border of the one around them.
#define GRID_SAME 1e-3f
// Cells from the world's origin to a place at most, so that no place is infinite.
#define GRID_MOST_CELLS 1e18f

// A grid about the box: the last one where it still fits, else that one moved by whole cells, whatever the unit (of more cells the
// box would not fit), else one of another size.
LW_FN LwGridPlace fitted(LwGridPlace last, LwGridFit fit, const float* low, const float* high) {
    const float size = (float)fit.size;
    const float longest = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    const float inner = (size - 2.0f) * last.cell.x;
    const int keeps = !fit.refit && last.origin.w > 0.0f && longest <= inner && longest >= GRID_LEAST * inner;
    const float cell = keeps ? last.cell.x : longest * GRID_SLACK / (size - 2.0f);
    float origin[3] = {last.origin.x, last.origin.y, last.origin.z};
    for (int axis = 0; axis < 3; ++axis) {
        const float wanted = 0.5f * (low[axis] + high[axis]) - 0.5f * size * cell;
        if (!keeps)
            origin[axis] = wanted;
        else if (low[axis] < origin[axis] + cell || high[axis] > origin[axis] + (size - 1.0f) * cell)
            origin[axis] += cell * round((wanted - origin[axis]) / cell);
        // From so far that a float does not know cells.
        if (!(fabs(origin[axis] - wanted) <= cell)) origin[axis] = wanted;
    }
    LwGridPlace place;
    place.origin = (float4)(origin[0], origin[1], origin[2], 0.0f);
    place.cell = (float4)(cell, 1.0f, 1.0f, 0.0f);
    return place;
}

// The corner of the world's runs of `run` (a length) that is nearest to the origin of positions, which lies a step from the world's:
// exact, as remainders are, however far that is.
LW_FN float nearest_run(float high, float low, float least, float run) {
    const float rest = fmod(high, run) + fmod(low, run) + fmod(least, run);
    return run * round(rest / run) - rest;
}
LW_FN float3 world_corner(float4 high, float4 low, float4 least, float run) {
    return (float3)(nearest_run(high.x, low.x, least.x, run), nearest_run(high.y, low.y, least.y, run),
                    nearest_run(high.z, low.z, least.z, run));
}

// Where the grid around a place begins, in cells from a corner of the world's runs of so many: at multiples of `unit`, so that it stays where it is while the
// place moves within so many cells, and all of its cells are cells of the world that light and blockers find again when it moves.
// A unit of size / 8 keeps all levels but the top three of a pyramid of cells where they are in the world.
LW_FN float3 snapped(float3 centre, float cell, int size, int unit) {
    const float3 units = floor((centre / cell + (float)(unit / 2)) / (float)unit);
    return clamp(units, -GRID_MOST_CELLS, GRID_MOST_CELLS) * (float)unit - (float)(size / 2);
}

// One work-item in all: a grid of cells half as large around a place, or around the middle of the one that it lies in; between its
// border and the other's is a cell of the other at least, so that what lies in it lies in the other as well.
__kernel void grid_place_nest(__global const LwGridPlace* outer, float4 focus, float4 stepHigh, float4 stepLow, float4 stepLeast, int size,
                              int unit, __global LwGridPlace* place) {
    if (get_global_id(0) != 0) return;
    LwGridPlace to = *outer;
    const float cell = 0.5f * to.cell.x;
    if (to.origin.w > 0.0f && cell > GRID_LEAST_CELL) {
        const float units = (float)unit;
        const float3 world = world_corner(stepHigh, stepLow, stepLeast, cell * units);
        const float3 middle = to.origin.xyz + to.cell.x * (float)(size / 2);
        const float3 corner = (to.origin.xyz - world) / cell / units;  // in units
        const int border = max(unit, 2);
        const float3 from = snapped((focus.w > 0.0f ? focus.xyz : middle) - world, cell, size, unit);
        to.origin.xyz = world + cell * clamp(from, ceil(corner - GRID_SAME) * units + (float)border,
                                             floor(corner + GRID_SAME) * units + (float)(size - border));
        to.origin.w = 1.0f / cell;
        to.cell.x = cell;
    } else {
        to.origin = (float4)(0.0f);
    }
    *place = to;
}

// One work-item in all.
__kernel void grid_place_fit(__global const uint* state, LwGridFit fit, __global LwGridPlace* place) {
    if (get_global_id(0) != 0) return;
    LwGridPlace to = *place;
    if (fit.centre.w > 0.0f) {
        const float half_ = 0.5f * fit.centre.w;
        to.cell.x = fit.centre.w / (float)fit.size;
        to.origin = (float4)(fit.centre.x - half_, fit.centre.y - half_, fit.centre.z - half_, 0.0f);
        if (fit.unit) {
            const float3 world = world_corner(fit.stepHigh, fit.stepLow, fit.stepLeast, to.cell.x * (float)fit.unit);
            to.origin.xyz = world + to.cell.x * snapped(fit.centre.xyz - world, to.cell.x, fit.size, fit.unit);
        }
    } else {
        float low[3] = {fit.low.x, fit.low.y, fit.low.z}, high[3] = {fit.high.x, fit.high.y, fit.high.z};
        int some = fit.low.w > 0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            if (state[LW_GRID_HIGH + axis] == 0u) continue;
            const float least = -of_key(state[LW_GRID_LOW + axis]), most = of_key(state[LW_GRID_HIGH + axis]);
            low[axis] = fit.low.w > 0.0f ? fmin(low[axis], least) : least;
            high[axis] = fit.low.w > 0.0f ? fmax(high[axis], most) : most;
            some = 1;
        }
        if (some)
            to = fitted(to, fit, low, high);
        else if (fit.refit)
            to.cell.x = 0.0f;
    }
    const int usable = to.cell.x > GRID_LEAST_CELL && to.cell.x < GRID_LARGEST_CELL;
    if (!usable) to.origin = (float4)(0.0f);
    to.origin.w = usable ? 1.0f / to.cell.x : 0.0f;
    // The largest flux is below 2^exponent.
    int exponent = 0;
    const float largest = as_float(state[LW_GRID_LARGEST]);
    if (largest > 0.0f) frexp(largest, &exponent);
    const int shift = largest > 0.0f ? fit.bits - exponent : 0;
    to.cell.y = ldexp(1.0f, shift / 2);
    to.cell.z = ldexp(1.0f, shift - shift / 2);
    *place = to;
}
