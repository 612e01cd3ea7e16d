// Irradiance of pixels, and of surfels that send light on, from the cells of a sweep.
#include "shared/input_limits.h"
#include "shared/lpv_sweep_cells.h"
#include "shared/lpv_types.h"
#include "shared/surface.h"
#include "shared/wide.h"

// As sweep_split, of LW_WIDTH pixels.
LW_FN real split(real g, int size, lanei* lower) {
    const real inside = clamp(g, (real)0.0f, (real)(float)(size - 1));
    *lower = min(to_lanei(inside), (lanei)(size - 2));
    return inside - to_real(*lower);
}

// One work-item = LW_WIDTH pixels of a row. hasIrradiance, hasValidity: which are wanted; the other's arguments are not
// touched. Validity is 1 where the grid has the surface, 0 elsewhere, where irradiance is 0 as well. counts[0]: pixels that are
// neither surface nor background; counts[1]: whose light was brought down; counts[2]: surfaces that the grid does not have.
__kernel void lpv_sweep_gather(__global const float* position, int4 positionLayout, __global const float* normal,
                               int4 normalLayout, int width, int height, __global const LwLpvPlace* grid, int size,
                               __global const float16* cells, int hasIrradiance, int hasValidity, __global float* irradiance,
                               int4 irradianceLayout, __global float* validity, int4 validityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = *grid;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask shown = lanei_iota() + x < width;
    const float inverse = place.origin.w, most = (float)size;
    // In cells from the grid's corner.
    const real gx = (s.px - place.origin.x) * inverse, gy = (s.py - place.origin.y) * inverse,
               gz = (s.pz - place.origin.z) * inverse;
    const real rx = fma_(s.nx, (real)0.5f, gx), ry = fma_(s.ny, (real)0.5f, gy), rz = fma_(s.nz, (real)0.5f, gz);
    const mask within = and_(and_(and_(rx >= 0.0f, rx <= most), and_(ry >= 0.0f, ry <= most)), and_(rz >= 0.0f, rz <= most));
    const mask has = and_(s.valid, and_(within, splat_mask(inverse > 0.0f)));

    const mask rejected = and_(s.rejected, shown), missing = and_(and_(s.valid, not_(has)), shown);
    if (any_(rejected)) atomic_add(counts, count_(rejected));
    if (any_(missing)) atomic_add(counts + 2, count_(missing));
    if (hasValidity) store(ones_(has), validity, validityLayout.x + y * validityLayout.y + x);
    if (!hasIrradiance) return;

    // Pixel by pixel: one load takes all of a cell's side, where lanes of pixels would gather every number alone.
    const real none = (real)0.0f;
    // Any unit normal where there is none, so that nothing is divided by 0.
    const real p[3] = {select_(none, gx, has), select_(none, gy, has), select_(none, gz, has)},
               n[3] = {select_((real)1.0f, s.nx, has), select_(none, s.ny, has), select_(none, s.nz, has)};
    float weights[2][8][LW_WIDTH], plus[3][LW_WIDTH], minus[3][LW_WIDTH], light[LW_SWEEP_COLOURS][LW_WIDTH];
    int corner[2][LW_WIDTH];
    for (int i = 0; i < 2; ++i) {
        const float above = (float)i + 0.5f;
        real f[3];
        lanei at = 0;
        for (int axis = 2; axis >= 0; --axis) {
            lanei lower;
            f[axis] = split(p[axis] + above * n[axis] - 0.5f, size, &lower);
            at = at * size + lower;
        }
        store(at * 2, corner[i], 0);
#define SWEEP_KEEP(k, weight) store(weight, weights[i][k], 0)
        SWEEP_WEIGH(real, SWEEP_KEEP, select_, f, n, above)
#undef SWEEP_KEEP
    }
    for (int axis = 0; axis < 3; ++axis) {
        store(sq(fmax(n[axis], none)), plus[axis], 0);
        store(sq(fmin(n[axis], none)), minus[axis], 0);
    }
    for (int l = 0; l < LW_WIDTH; ++l) {
        const float2 nx = (float2)(plus[0][l], minus[0][l]), ny = (float2)(plus[1][l], minus[1][l]), nz = (float2)(plus[2][l], minus[2][l]);
        const float4 near = sweep_sides(cells + corner[0][l], size, &weights[0][0][l], LW_WIDTH, nx, ny, nz),
                     far = sweep_sides(cells + corner[1][l], size, &weights[1][0][l], LW_WIDTH, nx, ny, nz);
        const float4 e = sweep_less(near, far);
        light[0][l] = e.x;
        light[1][l] = e.y;
        light[2][l] = e.z;
    }
    const int e = irradianceLayout.x + y * irradianceLayout.y + x;
    mask saturated = splat_mask(0);
    for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
        const real value = select_(none, load(light[c], 0), has);
        saturated = or_(saturated, not_(value <= LW_LARGEST_IRRADIANCE));  // beyond float's range it is not a number
        store(fmin(value, (real)LW_LARGEST_IRRADIANCE), irradiance, e + c * irradianceLayout.z);
    }
    saturated = and_(saturated, shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}
