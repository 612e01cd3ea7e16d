// What surfaces cover of the cells of a sweep's grid: area goes into the cell half a cell behind its surface, so that neither
// what the surface sends, half a cell in front of it, nor what arrives there is stopped by it. Sums are whole numbers of 64
// bits: the same bits in any order.
#include "shared/lpv_cells.h"
#include "shared/lpv_raster.h"
#include "shared/lpv_scroll.h"
#include "shared/lpv_sweep_normal.h"
#include "shared/lpv_types.h"
#include "shared/rsm_types.h"
#include "shared/surfel_types.h"
#include "shared/vpl_list.h"
#include "shared/whole_sums.h"

typedef struct {
    long sums[4];  // of the three sheets, and what they cover
    int cell, sheets[3];
} sweep_areas;

LW_FN void end_areas(sweep_areas* run, __global uint* sums, __global uint* marks) {
    if (run->cell < 0) return;
    __global uint* to = sums + 2 * LW_SWEEP_BLOCKS * run->cell;
    uint bits = 0u;
    for (int k = 0; k < 3; ++k) {
        if (run->sums[k]) bits |= 1u << run->sheets[k];
        add_long(to + 2 * run->sheets[k], run->sums[k]);
    }
    if (bits) atomic_or(marks + run->cell, bits);
    add_long(to + 2 * LW_SWEEP_COVER, run->sums[3]);
    for (int k = 0; k < 4; ++k) run->sums[k] = 0;
}

LW_FN sweep_areas no_areas(void) {
    sweep_areas run;
    for (int k = 0; k < 4; ++k) run.sums[k] = 0;
    for (int k = 0; k < 3; ++k) run.sheets[k] = 0;
    run.cell = -1;
    return run;
}

LW_FN float largest_coordinate(float nx, float ny, float nz) { return fmax(fmax(fabs(nx), fabs(ny)), fabs(nz)); }

LW_FN void sheets_of(const sweep_normal n, int* sheets) {
    for (int k = 0; k < 3; ++k) sheets[k] = min(n.bins[k], LW_SWEEP_NORMALS - 1 - n.bins[k]);
}

// Of an area in sides of a cell: what it adds to its three sheets, and to what they cover. The shares as they are: a plane across a
// cell shall close it, and what is too much lies along the plane.
LW_FN void units_of(const sweep_normal n, float sides, float nx, float ny, float nz, long* units) {
    const float full = sides * (float)(1 << LW_SWEEP_AREA_BITS);
    for (int k = 0; k < 3; ++k) units[k] = (long)(full * n.shares[k]);
    units[3] = (long)(full * largest_coordinate(nx, ny, nz));
}

LW_FN void add_units(sweep_areas* run, int cell, const int* sheets, long count, const long* units, __global uint* sums,
                     __global uint* marks) {
    if (cell != run->cell || sheets[0] != run->sheets[0] || sheets[1] != run->sheets[1] || sheets[2] != run->sheets[2]) {
        end_areas(run, sums, marks);
        run->cell = cell;
        for (int k = 0; k < 3; ++k) run->sheets[k] = sheets[k];
    }
    if (cell < 0) return;
    for (int k = 0; k < 4; ++k) run->sums[k] += count * units[k];
}

LW_FN void add_area(sweep_areas* run, const LwLpvPlace place, int size, float area, float px, float py, float pz, float nx,
                    float ny, float nz, __global uint* sums, __global uint* marks) {
    const sweep_normal n = normal_of(nx, ny, nz);
    int sheets[3];
    long units[4];
    sheets_of(n, sheets);
    units_of(n, fmin(area * place.origin.w * place.origin.w, LW_SWEEP_MOST_AREA), nx, ny, nz, units);
    add_units(run, cell_of(place, size, px, py, pz, nx, ny, nz, -0.5f), sheets, 1, units, sums, marks);
}

// One work-item in all: is what covers the cells still right, and which of them? anew: 1 where the host knows that it is not; scrolls: 1
// where what covers a cell is the same wherever the grid lies that has it.
__kernel void lpv_sweep_begin(__global const LwLpvPlace* grid, uint low, uint high, int anew, int scrolls, int size,
                              __global LwSweepCover* state) {
    if (get_global_id(0) != 0) return;
    const float4 origin = grid->origin, last = state->origin;
    const int isSame = !anew && state->revision[0] == low && state->revision[1] == high;
    state->stale = !isSame || origin.x != last.x || origin.y != last.y || origin.z != last.z || origin.w != last.w;
    if (!state->stale) return;
    LwLpvParts parts;
    parts_of(last, origin, isSame && scrolls, size, &parts);
    if (!scrolls) parts.slot = (int4)(0);
    state->parts = parts;
    state->origin = origin;
    state->revision[0] = low;
    state->revision[1] = high;
}

// Empties the sums of area and their marks where they are stale. One work-item = one cell (x; y and z).
__kernel void lpv_sweep_clear(__global uint* sums, int size, __global const LwSweepCover* state) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1), y = line % size, z = line / size;
    if (x >= size || line >= size * size || !state->stale || !parts_have(&state->parts, x, y, z)) return;
    const int at = slot_of(x, y, z, state->parts.slot, size);
    __global uint4* to = (__global uint4*)(sums + 2 * LW_SWEEP_BLOCKS * at);
    for (int i = 0; i < LW_SWEEP_BLOCKS / 2; ++i) to[i] = (uint4)(0u);
    sums[sweep_area_marks(size) + at] = 0u;
}

// One work-item = LW_SWEEP_RUN texels of all maps, lit or not. scale: of their areas.
__kernel void lpv_sweep_cover_texels(__global const float* texels, int4 layout, int count, __global const LwLpvPlace* grid,
                                     int size, float scale, __global const LwSweepCover* state,
                                     __global uint* sums) {
    if (!state->stale) return;
    const int first = lw_list_index() * LW_SWEEP_RUN, last = min(first + LW_SWEEP_RUN, count), stride = layout.z;
    const LwLpvPlace place = *grid;
    __global uint* marks = sums + sweep_area_marks(size);
    __global const float* base = texels + layout.x;
    sweep_areas run = no_areas();
    for (int i = first; i < last; ++i) {
        __global const float* p = base + i;
        const float nx = p[LW_RSM_NORMAL * stride], ny = p[(LW_RSM_NORMAL + 1) * stride], nz = p[(LW_RSM_NORMAL + 2) * stride];
        const float area = scale * p[LW_RSM_AREA * stride];
        if (!(nx * nx + ny * ny + nz * nz > 0.0f && area > 0.0f)) continue;
        add_area(&run, place, size, area, p[LW_RSM_POSITION * stride], p[(LW_RSM_POSITION + 1) * stride],
                 p[(LW_RSM_POSITION + 2) * stride], nx, ny, nz, sums, marks);
    }
    end_areas(&run, sums, marks);
}

// One work-item = LW_SWEEP_RUN surfels. scale: of their areas.
__kernel void lpv_sweep_cover_surfels(__global const float* surfels, int stride, int count, __global const LwLpvPlace* grid,
                                      int size, float scale, __global const LwSweepCover* state,
                                      __global uint* sums) {
    if (!state->stale) return;
    const int first = lw_list_index() * LW_SWEEP_RUN, last = min(first + LW_SWEEP_RUN, count);
    const LwLpvPlace place = *grid;
    __global uint* marks = sums + sweep_area_marks(size);
    sweep_areas run = no_areas();
    for (int i = first; i < last; ++i) {
        __global const float* p = surfels + i;
        const float radius = p[LW_SURFEL_RADIUS * stride];
        if (!(radius > 0.0f)) continue;
        add_area(&run, place, size, scale * M_PI_F * radius * radius, p[LW_SURFEL_POSITION * stride],
                 p[(LW_SURFEL_POSITION + 1) * stride], p[(LW_SURFEL_POSITION + 2) * stride], p[LW_SURFEL_NORMAL * stride],
                 p[(LW_SURFEL_NORMAL + 1) * stride], p[(LW_SURFEL_NORMAL + 2) * stride], sums, marks);
    }
    end_areas(&run, sums, marks);
}

// A grid's lattice, and the cells of a part of it that are made.
typedef struct {
    lpv_lattice lattice;
    int4 low, high, slot;
    int size;
} sweep_region;

LW_FN void cover_triangle(const lpv_raster* r, const sweep_region* region, sweep_areas* run, __global uint* sums, __global uint* marks) {
    const sweep_normal n = normal_of(r->nx, r->ny, r->nz);
    int sheets[3], cell = -1;
    long units[4], found = 0;  // of one sample; samples of the cell
    sheets_of(n, sheets);
    units_of(n, r->area, r->nx, r->ny, r->nz, units);
    for (int v = r->firstV; v <= r->lastV; ++v) {
        long edges[3];
        raster_row(r, v, edges);
        for (int u = r->firstU; u <= r->lastU; ++u) {
            float p[3];
            if (!raster_sample(r, u, v, edges)) continue;
            raster_place(r, u, v, p);
            const int x = whole_below(p[0] - 0.5f * r->nx) - region->lattice.corner[0],
                      y = whole_below(p[1] - 0.5f * r->ny) - region->lattice.corner[1],
                      z = whole_below(p[2] - 0.5f * r->nz) - region->lattice.corner[2];
            if (!part_has(region->low, region->high, x, y, z)) continue;
            const int to = slot_of(x, y, z, region->slot, region->size);
            if (to != cell) {
                if (cell >= 0) add_units(run, cell, sheets, found, units, sums, marks);
                cell = to;
                found = 0;
            }
            ++found;
        }
    }
    if (cell >= 0) add_units(run, cell, sheets, found, units, sums, marks);
}

// One work-item = one node of the tree over the triangles: the samples of its leaves' triangles on the grid's lattice, in those cells
// that are to be made.
__kernel void lpv_sweep_cover_triangles(__global const float* nodes, int nodeCount, __global const float* triangles, int stride,
                                        __global const LwLpvPlace* grid, int size, __global const LwSweepCover* state,
                                        __global uint* sums) {
    const int n = lw_list_index();
    const float scale = (float)LPV_RASTER * grid->origin.w;
    if (n >= nodeCount || !state->stale || !(scale > 0.0f)) return;
    __global const float* node = nodes + n * LW_TREE_NODE;
    __global uint* marks = sums + sweep_area_marks(size);
    sweep_region region;
    region.size = size;
    region.slot = state->parts.slot;
    lattice_of(grid->origin, &region.lattice);
    sweep_areas run = no_areas();
    for (int part = 0; part < state->parts.count; ++part) {
        region.low = state->parts.low[part];
        region.high = state->parts.high[part];
        for (int first = 0; first < LW_TREE_CHILDREN; first += LW_WIDTH)
            for (uint leaves = raster_leaves(node, first, &region.lattice, scale, region.low, region.high); leaves;) {
                __global const int* leaf = (__global const int*)node + first + take_lowest(&leaves);
                const int begin = leaf[LW_TREE_CHILD], end = begin + leaf[LW_TREE_COUNT];
                for (int t = begin; t < end; t += LW_WIDTH)
                    for (uint bits = raster_near(triangles, stride, t, &region.lattice, scale, region.low, region.high); bits;) {
                        const int k = t + take_lowest(&bits);
                        lpv_raster r;
                        if (k >= end || !raster_of(triangles, stride, k, &region.lattice, scale, &r)) continue;
                        raster_within(&r, &region.lattice, region.low, region.high);
                        cover_triangle(&r, &region, &run, sums, marks);
                    }
            }
    }
    end_areas(&run, sums, marks);
}
