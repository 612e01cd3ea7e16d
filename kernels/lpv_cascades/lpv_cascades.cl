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

// Sides of a fine cell with the light that `xy` and `z` bring, by how open it is. To most: the largest sum that arrives at a side.
LW_FN void bring(__global float16* cell, float16 xy, float8 z, float* most) {
    const float16 beforeXy = cell[0];
    const float8 beforeZ = *(__global const float8*)(cell + 1);
    const float open = beforeXy.s3;  // of all sides; never 0
    const float16 newXy = beforeXy + open * xy;
    const float8 newZ = beforeZ + open * z;
    cell[0] = newXy;
    *(__global float8*)(cell + 1) = newZ;
    const float8 pairs = fmax(fmax(newXy.lo, newXy.hi), newZ);
    const float4 largest = fmax(pairs.lo, pairs.hi);
    *most = fmax(fmax(largest.x, largest.y), largest.z) / open;
}

// Of sweeps, as pixels read it (lpv_sweep_pack): a coarse cell counts as much as it is open, or light from behind a wall would come
// in with the cells that the wall fills. What arrives at a side is irradiance, the same in cells of any size. hasTotal: the light is
// added to `total` as well. largest: bits of the largest sum, which order as the numbers do.
__kernel void lpv_cascades_add_sweeps(__global const LwLpvPlace* fineGrid, __global const LwLpvPlace* coarseGrid, int size,
                                      __global const float16* far, int hasTotal, __global float16* cells, __global float16* total,
                                      __global uint* largest) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const LwLpvPlace fine = *fineGrid, coarse = *coarseGrid;
    if (!(fine.origin.w > 0.0f)) return;
    const lpv_around a = around(fine, coarse, size, x, line % size, line / size);
    float16 xy = (float16)(0.0f);
    float8 z = (float8)(0.0f);
    for (int k = 0; k < 8; ++k) {
        __global const float16* cell = far + LW_SWEEP_CELL / 16 * cell_at(a, size, k);
        xy += share_of(a, k) * cell[0];
        z += share_of(a, k) * *(__global const float8*)(cell + 1);
    }
    // Light over openness; in the fourth numbers nothing, so that the fine cell's openness stays.
    const float each = 1.0f / xy.s3;
    const float4 none = (float4)(each, each, each, 0.0f);
    xy *= (float16)(none, none, none, none);
    z *= (float8)(none, none);
    const int at = LW_SWEEP_CELL / 16 * (line * size + x);
    float most = 0.0f, unused;
    bring(cells + at, xy, z, &most);
    if (hasTotal) bring(total + at, xy, z, &unused);
    if (most > 0.0f) atomic_max(largest, as_uint(most));
}
