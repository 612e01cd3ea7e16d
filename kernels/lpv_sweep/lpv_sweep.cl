// Light carried through a grid in a fixed set of directions, plane by plane (discrete ordinates, the short-characteristics form;
// after Fattal, Participating Media Illumination Using Light Propagation Maps, ACM TOG 2009, and S_N transport codes). For a
// direction d whose dominant axis is a:
//
//   arriving(cell) = bilinear(leaving(plane before), at -d_b / |d_a|, -d_c / |d_a|)
//   leaving(cell)  = (1 - alpha) arriving(cell) + sum Phi max(0, n.d) / (pi s^2 |d_a|)
//
// and what arrives, not what leaves, lights surfaces: a cell's own light and what its surfaces stop are not in it yet.
//
// alpha: a sheet whose cells are covered to c (1: closed) shall let through 1 - c of the light, whatever its angle. With
// t = |d_n| / |d_a| for the sheet's normal axis n, light stays in its layer for a geometrically distributed number of cells, of
// which each lets through u = 1 - alpha: in all t u / (1 - (1 - t) u). This is 1 - c for
//   u = (1 - c) / (1 - c + x),  x = sum A |n.d| / (s^2 |d_a|)  (= c t),
// and for few surfels it is the usual 1 - x. Plain u = 1 - x lets (1 - t) / (2 - t) of the light through a closed
// wall: half of what goes along it.
//
// One work-item does all planes of a group of directions, whose signs are the same: so every cell's sum over them stays in
// registers, and groups' sums are added up in one order. A plane is overwritten in place, from the far end to the near.
#include "shared/lpv_scroll.h"
#include "shared/lpv_sweep_types.h"
#include "shared/lpv_types.h"
#include "shared/whole_sums.h"
#include "shared/wide.h"

// Where an order of cells has cell (x, y, z).
LW_FN int cell_in(int order, int size, int x, int y, int z) {
    return order == 0 ? (z * size + y) * size + x : (z * size + x) * size + y;
}

// One work-item = a row of cells in one order (rows of a slice; slices and orders): sums to floats. Marks: of each cell the bits of
// the normals that send in it, and those of the sheets in it. used: the same of each row; planes of others are not written.
// changed: raised where light is other than it was; watches: 0: it is not touched.
__kernel void lpv_sweep_resolve(__global const uint* lights, __global const uint* areas, __global const LwSweepCover* cover,
                                __global const LwLpvPlace* grid, int size, __global float* sources, __global float* sheets,
                                __global uint* used, int watches, __global int* changed) {
    const int row = (int)get_global_id(0), line = (int)get_global_id(1);
    if (row >= size || line >= LW_SWEEP_ORDERS * size) return;
    const int order = line / size, z = line % size, cells = size * size * size, stride = LW_SWEEP_ORDERS * cells;
    const LwLpvPlace place = *grid;
    const float first = 1.0f / place.cell.y, second = 1.0f / place.cell.z, inverse = place.origin.w;
    const float unit = 1.0f / (float)(1 << LW_SWEEP_AREA_BITS);
    const int4 slot = cover->parts.slot;
    // A row in the second order is a column in the first.
    const int start = order == 0 ? (z * size + row) * size : z * size * size + row, step = order == 0 ? 1 : size;
    // Areas are kept in slots.
    const int kept = order == 0 ? slot_of(-slot.x, row, z, slot, size) : slot_of(row, -slot.y, z, slot, size),
              firstSlot = order == 0 ? slot.x : slot.y;
    __global const uint* lightMarks = lights + sweep_light_marks(size);
    __global const uint* areaMarks = areas + sweep_area_marks(size);
    uint sending = 0u, stopping = 0u;
    for (int i = 0; i < size; ++i) {
        sending |= lightMarks[start + i * step];
        stopping |= areaMarks[kept + step * i];  // in any order
    }
    const int at = order * cells + (z * size + row) * size;
    int isOther = watches && used[2 * (at / size)] != sending;
    used[2 * (at / size)] = sending;
    used[2 * (at / size) + 1] = stopping;
    for (int i = 0; i < size; ++i) {
        const int cell = start + i * step;
        __global const uint* light = lights + 2 * LW_SWEEP_SOURCES * cell;
        for (uint bits = sending; bits;) {
            const int k = LW_SWEEP_COLOURS * take_lowest(&bits);
            for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
                const float sent = convert_float(long_at(light + 2 * (k + c))) * first * second * inverse * inverse;
                isOther |= watches && sources[(k + c) * stride + at + i] != sent;
                sources[(k + c) * stride + at + i] = sent;
            }
        }
        const int from = kept + step * slot_along(firstSlot + i, size);
        __global const uint* area = areas + 2 * LW_SWEEP_BLOCKS * from;
        for (uint bits = stopping; bits;) {
            const int k = take_lowest(&bits);
            sheets[k * stride + at + i] = convert_float(long_at(area + 2 * k)) * unit;
        }
        const float closed = areaMarks[from] ? convert_float(long_at(area + 2 * LW_SWEEP_COVER)) * unit : 0.0f;
        sheets[LW_SWEEP_COVER * stride + at + i] = 1.0f - fmin(closed, 1.0f);
    }
    if (isOther) atomic_or(changed, 1);
}

// Work-items leave where the last frame's result stays. watches: 0: `rest` is not looked at.
LW_FN int rests(__global const LwLpvProgress* rest, int watches) { return watches && rest->done; }

// 1 - alpha of LW_WIDTH cells for a direction.
LW_FN real passing(__global const float* sheets, int at, int stride, uint stopping, __global const float* direction) {
    real x = (real)0.0f;
    while (stopping) {
        const int k = take_lowest(&stopping);
        x = fma_(load_whole(sheets + k * stride + at), direction[LW_SWEEP_STOP + k], x);
    }
    const real open = load_whole(sheets + LW_SWEEP_COVER * stride + at);
    return open / fmax(open + x, (real)1e-20f);
}

// One work-item = a group of directions, of which there are `count`; groups from firstGroup on. carried: the planes' light, of
// three colours for each direction. parts: what arrives in the cells, LW_SWEEP_PARTS planes of cells for each group.
// environment: radiance that comes from outside of the grid, of each colour. Before the first plane and beside every one it is
// all there is; nothing else writes there.
__kernel void lpv_sweep_march(__global const float* sources, __global const float* sheets, __global const uint* used,
                              __global const float* directions, int count, int size, int firstGroup, int groupCount,
                              __global float* carried, __global float* parts, float4 environment,
                              __global const LwLpvProgress* rest, int watches) {
    const int item = (int)get_global_id(0);
    if (item >= groupCount || rests(rest, watches)) return;
    const int group = firstGroup + item, axis = group >> 3, octant = group & 7;
    const int cells = size * size * size, stride = LW_SWEEP_ORDERS * cells;
    const int order = axis == 0 ? 1 : 0;
    const int planeStep = axis == 2 ? size * size : size, rowStep = axis == 2 ? size : size * size;
    const int planeSign = octant >> axis & 1, rowSign = octant >> (axis == 2 ? 1 : 2) & 1,
              laneSign = octant >> (axis == 0 ? 1 : 0) & 1;
    const int across = sweep_row(size), plane = sweep_plane(size);
    const int laneBack = laneSign ? -1 : 1, rowBack = rowSign ? -across : across;
    __global float* own = carried + item * count * LW_SWEEP_COLOURS * plane;
    for (int k = 0; k < count * LW_SWEEP_COLOURS; ++k) {
        const int c = k % LW_SWEEP_COLOURS;
        const real outside = (real)(c == 0 ? environment.x : c == 1 ? environment.y : environment.z);
        for (int i = 0; i < plane; i += LW_WIDTH) store(outside, own, k * plane + i);
    }
    __global const float* set = directions + group * count * LW_SWEEP_DIRECTION;
    __global float* out = parts + group * LW_SWEEP_PARTS * cells;
    for (int p = 0; p < size; ++p)
        for (int r = 0; r < size; ++r)
            for (int l = 0; l < size; l += LW_WIDTH) {
                const int row = rowSign ? size - 1 - r : r, lane = laneSign ? size - LW_WIDTH - l : l;
                const int line = (planeSign ? p : size - 1 - p) * planeStep + row * rowStep, at = line + lane;
                __global const uint* uses = used + 2 * ((order * cells + line) / size);
                const uint sending = uses[0], stopping = uses[1];
                real sum[LW_SWEEP_PARTS];
                _Pragma("unroll") for (int k = 0; k < LW_SWEEP_PARTS; ++k) sum[k] = (real)0.0f;
                for (int d = 0; d < count; ++d) {
                    __global const float* direction = set + d * LW_SWEEP_DIRECTION;
                    __global float* light = own + d * LW_SWEEP_COLOURS * plane + LW_SWEEP_PAD + (row + 1) * across + lane;
                    const real through =
                        stopping ? passing(sheets, order * cells + at, stride, stopping, direction) : (real)1.0f;
                    _Pragma("unroll") for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
                        __global float* from = light + c * plane;
                        const real arriving =
                            fma_(load_whole(from + laneBack + rowBack), direction[3],
                                 fma_(load_whole(from + rowBack), direction[2],
                                      fma_(load_whole(from + laneBack), direction[1], load_whole(from) * direction[0])));
                        _Pragma("unroll") for (int k = c; k < LW_SWEEP_PARTS; k += LW_SWEEP_COLOURS)
                            sum[k] = fma_(arriving, direction[LW_SWEEP_WEIGHTS + k / LW_SWEEP_COLOURS], sum[k]);
                        real leaving = arriving * through;
                        uint bits = sending;
                        while (bits) {
                            const int k = take_lowest(&bits);
                            leaving = fma_(load_whole(sources + (LW_SWEEP_COLOURS * k + c) * stride + order * cells + at),
                                           direction[LW_SWEEP_SEND + k], leaving);
                        }
                        store(leaving, from, 0);
                    }
                }
                _Pragma("unroll") for (int k = 0; k < LW_SWEEP_PARTS; ++k) store(sum[k], out, k * cells + at);
            }
}

// One work-item = LW_WIDTH cells of one side, colour and order: what that order's groups, one axis' or the other two's, bring there.
__kernel void lpv_sweep_combine(__global const float* parts, int size, __global float* sides, __global const LwLpvProgress* rest,
                                int watches) {
    const int cells = size * size * size, at = (int)get_global_id(0) * LW_WIDTH, plane = (int)get_global_id(1);
    if (at >= cells || plane >= LW_SWEEP_ORDERS * LW_SWEEP_SIDES * LW_SWEEP_COLOURS || rests(rest, watches)) return;
    const int order = plane / (LW_SWEEP_SIDES * LW_SWEEP_COLOURS), side = plane / LW_SWEEP_COLOURS % LW_SWEEP_SIDES;
    const int axis = side / 2, positive = side & 1;  // of the light that the side meets
    const int part = LW_SWEEP_COLOURS * axis + plane % LW_SWEEP_COLOURS;
    const int first = order == 0 ? 8 : 0, last = order == 0 ? LW_SWEEP_GROUPS : 8;
    real sum = (real)0.0f;
    for (int group = first; group < last; ++group)
        if ((group >> axis & 1) == positive) sum += load_whole(parts + (group * LW_SWEEP_PARTS + part) * cells + at);
    store(sum, sides, plane * cells + at);
}

// How open a cell is to readers at least: where all eight cells around a point are closed they still have their light to show.
#define SWEEP_LEAST_OPEN 1e-3f

// One work-item = one cell (x; y and z): what arrives at its sides, for pixels to read; where hasTotal, added to `total` as well.
// largest: bits of the largest sum, which order as the numbers do.
__kernel void lpv_sweep_pack(__global const float* sides, __global const float* sheets, int size, int hasTotal,
                             __global float* to, __global float* total, __global uint* largest,
                             __global const LwLpvProgress* rest, int watches) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size || rests(rest, watches)) return;
    const int cells = size * size * size, here = line * size + x, there = cell_in(1, size, x, line % size, line / size);
    const float open = fmax(sheets[LW_SWEEP_COVER * LW_SWEEP_ORDERS * cells + here], SWEEP_LEAST_OPEN);
    float most = 0.0f;
    for (int side = 0; side < LW_SWEEP_SIDES; ++side) {
        const int at = LW_SWEEP_CELL * here + 4 * side;
        for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
            __global const float* from = sides + (LW_SWEEP_COLOURS * side + c) * cells;
            const float sum = from[here] + from[LW_SWEEP_SIDES * LW_SWEEP_COLOURS * cells + there];
            most = fmax(most, sum);
            to[at + c] = open * sum;
            if (hasTotal) total[at + c] += open * sum;
        }
        to[at + 3] = open;
    }
    if (most > 0.0f) atomic_max(largest, as_uint(most));
}
