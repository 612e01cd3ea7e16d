// Light that the lights outside of a fine grid bring into it, from the coarser grid around it (Kaplanyan and Dachsbacher 2010 nest
// grids; here each path of light is in one of them). A fine grid carries the light of its own lights, the coarser one once that of all
// its lights, for what lies outside of the fine grid, and once that of the lights outside of it. The latter is added to the fine
// grid's cells, interpolated between coarse ones, so that a surface reads one grid.
#include "shared/lpv_sweep_types.h"
#include "shared/lpv_types.h"
#include "shared/wide.h"

// The eight coarse cells around the middle of a fine one; shares of the upper ones.
typedef struct {
    int corner;
    float x, y, z;
} lpv_around;

LW_FN float split_at(float g, int size, int* lower) {
    const float inside = clamp(g, 0.0f, (float)(size - 1));
    *lower = min((int)inside, size - 2);
    return inside - (float)*lower;
}

LW_FN lpv_around around(const LwLpvPlace fine, const LwLpvPlace coarse, int size, int x, int y, int z) {
    lpv_around a;
    int ix, iy, iz;
    const float step = fine.cell.x * coarse.origin.w;
    a.x = split_at((fine.origin.x - coarse.origin.x) * coarse.origin.w + ((float)x + 0.5f) * step - 0.5f, size, &ix);
    a.y = split_at((fine.origin.y - coarse.origin.y) * coarse.origin.w + ((float)y + 0.5f) * step - 0.5f, size, &iy);
    a.z = split_at((fine.origin.z - coarse.origin.z) * coarse.origin.w + ((float)z + 0.5f) * step - 0.5f, size, &iz);
    a.corner = (iz * size + iy) * size + ix;
    return a;
}

LW_FN float share_of(const lpv_around a, int k) {
    return ((k & 1) ? a.x : 1.0f - a.x) * ((k & 2) ? a.y : 1.0f - a.y) * ((k & 4) ? a.z : 1.0f - a.z);
}
LW_FN int cell_at(const lpv_around a, int size, int k) {
    return a.corner + ((k & 1) ? 1 : 0) + ((k & 2) ? size : 0) + ((k & 4) ? size * size : 0);
}

// Of propagated light, as pixels read it (lpv_read). One work-item = one fine cell (x; y and z). What a surface reads of a cell it
// divides by the square of that cell's side.
__kernel void lpv_cascades_add_steps(__global const LwLpvPlace* fineGrid, __global const LwLpvPlace* coarseGrid, int size,
                                     __global const float16* far, __global float16* cells) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const LwLpvPlace fine = *fineGrid, coarse = *coarseGrid;
    if (!(fine.origin.w > 0.0f)) return;
    const lpv_around a = around(fine, coarse, size, x, line % size, line / size);
    const float ratio = fine.cell.x * coarse.origin.w;
    float16 light = (float16)(0.0f);
    for (int k = 0; k < 8; ++k) light += share_of(a, k) * far[cell_at(a, size, k)];
    cells[line * size + x] += ratio * ratio * light;
}

// Of sweeps, as pixels read it (lpv_sweep_pack): a coarse cell counts as much as it is open, or light from behind a wall would come
// in with the cells that the wall fills. What arrives at a side is irradiance, the same in cells of any size. hasTotal: the light is
// added to `total` as well. largest: bits of the largest sum, which order as the numbers do.
__kernel void lpv_cascades_add_sweeps(__global const LwLpvPlace* fineGrid, __global const LwLpvPlace* coarseGrid, int size,
                                      __global const float4* far, int hasTotal, __global float4* cells, __global float4* total,
                                      __global uint* largest) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const LwLpvPlace fine = *fineGrid, coarse = *coarseGrid;
    if (!(fine.origin.w > 0.0f)) return;
    const lpv_around a = around(fine, coarse, size, x, line % size, line / size);
    float most = 0.0f;
    for (int side = 0; side < LW_SWEEP_SIDES; ++side) {
        float4 light = (float4)(0.0f);
        for (int k = 0; k < 8; ++k) light += share_of(a, k) * far[LW_SWEEP_CELL / 4 * cell_at(a, size, k) + side];
        const int at = LW_SWEEP_CELL / 4 * (line * size + x) + side;
        const float4 before = cells[at];
        const float open = before.w;  // never 0, as no coarse cell's is
        const float4 brought = (float4)(light.xyz * (open / light.w), 0.0f);
        cells[at] = before + brought;
        if (hasTotal) total[at] += brought;
        most = fmax(most, fmax(fmax(before.x + brought.x, before.y + brought.y), before.z + brought.z) / open);
    }
    if (most > 0.0f) atomic_max(largest, as_uint(most));
}
