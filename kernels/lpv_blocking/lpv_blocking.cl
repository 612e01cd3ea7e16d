// What blocks light between the cells of a light propagation volume (Kaplanyan and Dachsbacher 2010, section 4.2): surfels,
// each A / s^2 lobe(n) at the corner of cells that is nearest to it, so that a wall stands between the cells it parts and not in
// one of them; light that a surface sends is injected into the cell above that corner. Of a face, the mean B of its four corners
// lets through
//   T(d) = 1 - clamp(max(B(d), B(-d)) / B_full, 0, 1),
// from both sides alike. B_full = 1/4 + 1/sqrt(5) is what a wall that fills its cells has on the obliquest way through, 2/sqrt(5)
// along its normal: no way through such a wall is open. (With 3/4, its lobe straight on, each sheet lets 2.1 % through.)
//
// Sums are whole numbers, the same bits in any order. Several views of one surface are not added up but merged: of each corner,
// the view whose first coefficient is larger is taken whole.
#include "shared/lpv_raster.h"
#include "shared/lpv_scroll.h"
#include "shared/lpv_types.h"
#include "shared/surfel_types.h"
#include "shared/vpl_list.h"
#include "shared/whole_sums.h"
#include "shared/wide.h"

#define LPV_Y0 0.2820947918f
#define LPV_Y1 0.4886025119f
#define LPV_LOBE0 0.8862269255f
#define LPV_LOBE1 1.0233267079f
#define LPV_FULL 1.4342807f  // 1 / B_full. Less: walls leak however thick; more: what is half open is closed
#define LPV_ROOT5 2.2360679775f
// Surfels of a work-item, which adds up those of one corner before it touches memory that others write as well.
#define LPV_RUN 64
// Of one full cell's side, in whole numbers; and the most that one surfel may add, in cells' sides. Surfels larger than
// that block as much at one corner, and nothing beside it. 2^31 surfels of the most stay below 2^63.
#define LPV_WHOLE 536870912.0f
#define LPV_MOST 4.0f

// Surfaces block from both sides, so that a normal's sign says nothing; but where a thin wall has surfels on both of its sides,
// opposite ones would leave no more than the first coefficient, and 28 % of the light would get through. So all point to one
// side of a plane, which no axis and no diagonal of the cells lies in, as walls like to.
#define LPV_SIDE(x, y, z) ((x) + 1.8f * (y) + 3.4f * (z))

// One work-item in all: is what was made last still right, and of which corners? scrolls: 1 where what is at a corner is the same
// wherever the grid lies that has it.
__kernel void lpv_blocking_begin(__global const LwLpvPlace* place, uint low, uint high, int anew, int scrolls, int size,
                                 __global LwLpvBlockers* state) {
    if (get_global_id(0) != 0) return;
    const float4 origin = place->origin, last = state->origin;
    const int isSame = !anew && state->revision[0] == low && state->revision[1] == high;
    state->stale = !isSame || origin.x != last.x || origin.y != last.y || origin.z != last.z || origin.w != last.w;
    if (!state->stale) return;
    LwLpvParts parts;
    parts_of(last, origin, isSame && scrolls, size + 1, &parts);
    state->parts = parts;
    if (scrolls) state->current = 1 - state->current;
    state->origin = origin;
    state->revision[0] = low;
    state->revision[1] = high;
    state->surfelsOutside = 0;
}

// The corner nearest to a place, or -1.
LW_FN int corner_of(const LwLpvPlace place, int size, float px, float py, float pz) {
    const float inverse = place.origin.w, most = (float)(size + 1);
    const float x = (px - place.origin.x) * inverse + 0.5f, y = (py - place.origin.y) * inverse + 0.5f,
                z = (pz - place.origin.z) * inverse + 0.5f;
    if (!(inverse > 0.0f && x >= 0.0f && x < most && y >= 0.0f && y < most && z >= 0.0f && z < most)) return -1;
    return ((int)z * (size + 1) + (int)y) * (size + 1) + (int)x;
}

LW_FN void end_run(long* run, int corner, __global uint* sums) {
    if (corner < 0) return;
    for (int b = 0; b < LW_LPV_BANDS; ++b) {
        add_long(sums + 2 * (LW_LPV_BANDS * corner + b), run[b]);
        run[b] = 0;
    }
}

// One work-item = LPV_RUN of `count` surfels from `first` on, whose planes are `stride` floats apart. sums: two halves of 64 bits
// for each of a corner's coefficients.
__kernel void lpv_blocking_inject(__global const float* surfels, int stride, int first, int count,
                                  __global const LwLpvPlace* grid, int size, __global uint* sums, __global LwLpvBlockers* state) {
    const int begin = lw_list_index() * LPV_RUN, end = min(begin + LPV_RUN, count);
    if (begin >= count || !state->stale) return;
    const LwLpvPlace place = *grid;
    long run[LW_LPV_BANDS] = {0, 0, 0, 0};
    int corner = -1, outside = 0;
    for (int i = begin; i < end; ++i) {
        __global const float* p = surfels + first + i;
        const float radius = p[LW_SURFEL_RADIUS * stride];
        if (!(radius > 0.0f)) continue;
        const float px = p[LW_SURFEL_POSITION * stride], py = p[(LW_SURFEL_POSITION + 1) * stride],
                    pz = p[(LW_SURFEL_POSITION + 2) * stride];
        const int to = corner_of(place, size, px, py, pz);
        if (to != corner) {
            end_run(run, corner, sums);
            corner = to;
        }
        if (to < 0) {
            ++outside;
            continue;
        }
        const float nx = p[LW_SURFEL_NORMAL * stride], ny = p[(LW_SURFEL_NORMAL + 1) * stride],
                    nz = p[(LW_SURFEL_NORMAL + 2) * stride];
        const float r = radius * place.origin.w, full = fmin(M_PI_F * r * r, LPV_MOST) * LPV_WHOLE;
        const float linear = (LPV_SIDE(nx, ny, nz) < 0.0f ? -LPV_LOBE1 : LPV_LOBE1) * full;
        run[0] += (long)(LPV_LOBE0 * full);
        run[1] += (long)(linear * nx);
        run[2] += (long)(linear * ny);
        run[3] += (long)(linear * nz);
    }
    end_run(run, corner, sums);
    if (outside) atomic_add(&state->surfelsOutside, outside);
}

// A grid's lattice, and the corners of a part of it that are made.
typedef struct {
    lpv_lattice lattice;
    int4 low, high;
    int size;
} lpv_region;

LW_FN int block_triangle(const lpv_raster* r, const lpv_region* region, int corner, long* run, __global uint* sums) {
    const float full = r->area * LPV_WHOLE;
    const float linear = (LPV_SIDE(r->nx, r->ny, r->nz) < 0.0f ? -LPV_LOBE1 : LPV_LOBE1) * full;
    const long units[LW_LPV_BANDS] = {(long)(LPV_LOBE0 * full), (long)(linear * r->nx), (long)(linear * r->ny), (long)(linear * r->nz)};
    const int side = region->size + 1;
    for (int v = r->firstV; v <= r->lastV; ++v) {
        long edges[3];
        raster_row(r, v, edges);
        for (int u = r->firstU; u <= r->lastU; ++u) {
            float p[3];
            if (!raster_sample(r, u, v, edges)) continue;
            raster_place(r, u, v, p);
            const int x = whole_below(p[0] + 0.5f) - region->lattice.corner[0], y = whole_below(p[1] + 0.5f) - region->lattice.corner[1],
                      z = whole_below(p[2] + 0.5f) - region->lattice.corner[2];
            if (!part_has(region->low, region->high, x, y, z)) continue;
            const int to = (z * side + y) * side + x;
            if (to != corner) {
                end_run(run, corner, sums);
                corner = to;
            }
            for (int b = 0; b < LW_LPV_BANDS; ++b) run[b] += units[b];
        }
    }
    return corner;
}

// One work-item = one node of the tree over the triangles: the samples of its leaves' triangles on the grid's lattice, at those corners
// that are to be made.
__kernel void lpv_blocking_triangles(__global const float* nodes, int nodeCount, __global const float* triangles, int stride,
                                     __global const LwLpvPlace* grid, int size, __global uint* sums,
                                     __global const LwLpvBlockers* state) {
    const int n = lw_list_index();
    const float scale = (float)LPV_RASTER * grid->origin.w;
    if (n >= nodeCount || !state->stale || !(scale > 0.0f)) return;
    __global const float* node = nodes + n * LW_TREE_NODE;
    lpv_region region;
    region.size = size;
    lattice_of(grid->origin, &region.lattice);
    long run[LW_LPV_BANDS] = {0, 0, 0, 0};
    int corner = -1;
    for (int part = 0; part < state->parts.count; ++part) {
        region.low = state->parts.low[part];
        region.high = state->parts.high[part];
        const int4 reach = region.high - 1;  // the last corners', half a cell on: as far as the cells before them do
        for (int first = 0; first < LW_TREE_CHILDREN; first += LW_WIDTH)
            for (uint leaves = raster_leaves(node, first, &region.lattice, scale, region.low, reach); leaves;) {
                __global const int* leaf = (__global const int*)node + first + take_lowest(&leaves);
                const int begin = leaf[LW_TREE_CHILD], end = begin + leaf[LW_TREE_COUNT];
                for (int t = begin; t < end; t += LW_WIDTH)
                    for (uint bits = raster_near(triangles, stride, t, &region.lattice, scale, region.low, reach); bits;) {
                        const int k = t + take_lowest(&bits);
                        lpv_raster r;
                        if (k >= end || !raster_of(triangles, stride, k, &region.lattice, scale, &r)) continue;
                        raster_within(&r, &region.lattice, region.low, reach);
                        corner = block_triangle(&r, &region, corner, run, sums);
                    }
            }
    }
    end_run(run, corner, sums);
}

// One work-item = one corner (x; y and z). That is to be made: its sums, which are emptied, as a vector; of the first view, or where it
// blocks more than those before. That stayed: as it was, from the other of the two arrays.
__kernel void lpv_blocking_merge(__global uint* sums, int size, int isFirst, __global float4* merged, __global float4* other,
                                 __global const LwLpvBlockers* state) {
    const int side = size + 1, x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % side, z = line / side;
    if (x >= side || line >= side * side || !state->stale) return;
    const int at = line * side + x;
    __global float4* now = state->current ? other : merged;
    __global const float4* last = state->current ? merged : other;
    if (!parts_have(&state->parts, x, y, z)) {
        const int4 shift = state->parts.shift;
        now[at] = last[((z + shift.z) * side + y + shift.y) * side + x + shift.x];
        return;
    }
    __global uint* from = sums + 2 * LW_LPV_BANDS * at;
    const float scale = 1.0f / LPV_WHOLE;
    const float4 found = (float4)(convert_float(long_at(from)), convert_float(long_at(from + 2)), convert_float(long_at(from + 4)),
                                  convert_float(long_at(from + 6))) * scale;
    for (int i = 0; i < 2 * LW_LPV_BANDS; ++i) from[i] = 0u;
    if (isFirst || found.x > now[at].x) now[at] = found;
}

// What gets through where blockers of first coefficient b0 have `linear` = c1 . d: |c1 . d| is the larger one of d and -d.
LW_FN float through(float b0, float linear) {
    return 1.0f - clamp(LPV_FULL * (LPV_Y0 * b0 + LPV_Y1 * fabs(linear)), 0.0f, 1.0f);
}

LW_FN void face_ways(float4 b, float e, float u, float v, __global float* to, int plane) {
    const float oblique = 1.0f / LPV_ROOT5;
    to[0] = through(b.x, e);
    to[plane] = through(b.x, (2.0f * e + u) * oblique);
    to[2 * plane] = through(b.x, (2.0f * e - u) * oblique);
    to[3 * plane] = through(b.x, (2.0f * e + v) * oblique);
    to[4 * plane] = through(b.x, (2.0f * e - v) * oblique);
}

// One work-item = one cell (x; y and z): its three faces towards lower neighbours.
__kernel void lpv_blocking_faces(__global const float4* merged, __global const float4* other, int size, __global float* faces,
                                 __global const LwLpvBlockers* state) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size, row = size + 1,
              slice = row * row, plane = lpv_plane(size);
    if (x >= size || line >= size * size || !state->stale) return;
    __global const float4* b = (state->current ? other : merged) + (z * row + y) * row + x;
    __global float* to = faces + lpv_cell(size, x, y, z);
    const float4 bx = 0.25f * ((b[0] + b[row]) + (b[slice] + b[slice + row])),
                 by = 0.25f * ((b[0] + b[1]) + (b[slice] + b[slice + 1])), bz = 0.25f * ((b[0] + b[1]) + (b[row] + b[row + 1]));
    face_ways(bx, bx.y, bx.z, bx.w, to, plane);
    face_ways(by, by.z, by.y, by.w, to + LW_LPV_WAYS * plane, plane);
    face_ways(bz, bz.w, bz.y, bz.z, to + 2 * LW_LPV_WAYS * plane, plane);
}

// One work-item = LW_LPV_BLOCK_RUN cells of a row (x; y and z): 1 where anything blocks at their corners.
__kernel void lpv_blocking_runs(__global const float4* merged, __global const float4* other, int size, __global int* runs,
                                __global const LwLpvBlockers* state) {
    const int count = size / LW_LPV_BLOCK_RUN, run = (int)get_global_id(0), line = (int)get_global_id(1), row = size + 1;
    if (run >= count || line >= size * size || !state->stale) return;
    __global const float4* b = (state->current ? other : merged) + (line / size * row + line % size) * row + run * LW_LPV_BLOCK_RUN;
    float most = 0.0f;
    for (int i = 0; i <= LW_LPV_BLOCK_RUN; ++i)
        most = fmax(most, fmax(fmax(b[i].x, b[i + row].x), fmax(b[i + row * row].x, b[i + row * row + row].x)));
    runs[line * count + run] = most > 0.0f;
}
