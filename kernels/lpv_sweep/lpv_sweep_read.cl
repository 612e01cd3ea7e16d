// Irradiance of pixels, and of surfels that send light on, from the cells of a sweep; and light at points.
#include "shared/input_limits.h"
#include "shared/lpv_layer_bands.h"
#include "shared/lpv_layers.h"
#include "shared/lpv_sweep_cells.h"
#include "shared/lpv_types.h"
#include "shared/points.h"
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
//
// grids: of `layers` nested ones this is number `layer` (shared/lpv_layers.h). All but the coarsest, the last, change irradiance alone.
__kernel void lpv_sweep_gather(__global const float* position, int4 positionLayout, __global const float* normal,
                               int4 normalLayout, int width, int height, __global const LwLpvPlace* grids, int layer, int layers,
                               int size, __global const float16* cells, int hasIrradiance, int hasValidity, __global float* irradiance,
                               int4 irradianceLayout, __global float* validity, int4 validityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = grids[layer];
    const int isCoarsest = layer + 1 == layers;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask shown = lanei_iota() + x < width;
    const float inverse = place.origin.w, most = (float)size;
    // In cells from the grid's corner.
    const real gx = (s.px - place.origin.x) * inverse, gy = (s.py - place.origin.y) * inverse,
               gz = (s.pz - place.origin.z) * inverse;
    const real rx = fma_(s.nx, (real)0.5f, gx), ry = fma_(s.ny, (real)0.5f, gy), rz = fma_(s.nz, (real)0.5f, gz);
    const mask within = and_(and_(and_(rx >= 0.0f, rx <= most), and_(ry >= 0.0f, ry <= most)), and_(rz >= 0.0f, rz <= most));
    const mask has = and_(s.valid, and_(within, splat_mask(inverse > 0.0f)));

    if (isCoarsest) {
        const mask rejected = and_(s.rejected, shown), missing = and_(and_(s.valid, not_(has)), shown);
        if (any_(rejected)) atomic_add(counts, count_(rejected));
        if (any_(missing)) atomic_add(counts + 2, count_(missing));
        if (hasValidity) store(ones_(has), validity, validityLayout.x + y * validityLayout.y + x);
    }
    if (!hasIrradiance) return;
    mask some = s.valid;
    if (isCoarsest) some = has;
    const lpv_layer own = layer_of(grids, layer, layers, size, s.px, s.py, s.pz, some);
    if (!isCoarsest && !any_(and_(own.read, shown))) return;

    // Pixel by pixel: one load takes all of a cell's side, where lanes of pixels would gather every number alone.
    const real none = (real)0.0f;
    // Any unit normal where there is none, so that nothing is divided by 0.
    const real p[3] = {select_(none, gx, own.read), select_(none, gy, own.read), select_(none, gz, own.read)},
               n[3] = {select_((real)1.0f, s.nx, own.read), select_(none, s.ny, own.read), select_(none, s.nz, own.read)};
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
    // All or none: a branch for each pixel takes a third more time.
    const int count = any_(own.read) ? LW_WIDTH : 0;
    for (int c = 0; c < LW_SWEEP_COLOURS; ++c) store(none, light[c], 0);
    for (int l = 0; l < count; ++l) {
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
        const int at = e + c * irradianceLayout.z;
        real coarser = none;
        if (!isCoarsest) coarser = load(irradiance, at);
        const real found = select_(none, load(light[c], 0), own.read);
        // Beyond float's range it is not a number.
        const mask cut = and_(coarser >= LW_LARGEST_IRRADIANCE, own.share < 1.0f);
        saturated = or_(saturated, and_(own.read, or_(not_(found <= LW_LARGEST_IRRADIANCE), cut)));
        store(layered(own, coarser, fmin(found, (real)LW_LARGEST_IRRADIANCE)), irradiance, at);
    }
    saturated = and_(saturated, own.isLast);
    saturated = and_(saturated, shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}

// One work-item = LW_WIDTH points of a row: the light that arrives there, in two bands. The cells know q, the irradiance of their
// six sides. Those of an axis differ by the light's vector along it, so that c1 = Y1 (q(+) - q(-)) is exact; c0 = sum q / (6 pi Y0) is
// what fits all six best, and exact for light that is the same from everywhere: of light from one direction d it is
// 2/3 (|d.x| + |d.y| + |d.z|) of what it should be, 0.67 along an axis, 1.15 along a diagonal, 1 on average. Read once, half a cell
// off a surface; points without normals read where they are. hasHarmonics, hasValidity, validity and counts: as
// lpv_sweep_gather's.
__kernel void lpv_sweep_harmonics(__global const float* position, int4 positionLayout, __global const float* normal,
                                  int4 normalLayout, int hasNormals, int width, int height, __global const LwLpvPlace* grids,
                                  int layer, int layers, int size, __global const float16* cells, int hasHarmonics, int hasValidity,
                                  __global float* harmonics, int4 harmonicsLayout, int band, __global float* validity,
                                  int4 validityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = grids[layer];
    const int isCoarsest = layer + 1 == layers;
    const lw_surface s = load_point(position, positionLayout, normal, normalLayout, hasNormals, x, y);
    const mask shown = lanei_iota() + x < width;
    const float above = hasNormals ? 0.5f : 0.0f, inverse = place.origin.w, most = (float)size;
    const real n[3] = {s.nx, s.ny, s.nz};
    real r[3] = {(s.px - place.origin.x) * inverse, (s.py - place.origin.y) * inverse, (s.pz - place.origin.z) * inverse};
    mask has = and_(s.valid, splat_mask(inverse > 0.0f));
    for (int axis = 0; axis < 3; ++axis) {
        r[axis] = fma_(n[axis], (real)above, r[axis]);
        has = and_(has, and_(r[axis] >= 0.0f, r[axis] <= most));
    }
    if (isCoarsest) {
        const mask missing = and_(and_(s.valid, not_(has)), shown);
        if (any_(missing)) atomic_add(counts + 2, count_(missing));
        if (hasValidity) store(ones_(has), validity, validityLayout.x + y * validityLayout.y + x);
    }
    if (!hasHarmonics) return;
    mask some = s.valid;
    if (isCoarsest) some = has;
    const lpv_layer own = layer_of(grids, layer, layers, size, s.px, s.py, s.pz, some);
    if (!isCoarsest && !any_(and_(own.read, shown))) return;

    float weights[8][LW_WIDTH], sides[LW_SWEEP_SIDES][LW_SWEEP_COLOURS][LW_WIDTH];
    int corner[LW_WIDTH];
    real f[3];
    lanei at = 0;
    for (int axis = 2; axis >= 0; --axis) {
        lanei lower;
        f[axis] = split(select_((real)0.0f, r[axis] - 0.5f, own.read), size, &lower);
        at = at * size + lower;
    }
    store(at * 2, corner, 0);
    // Without a normal nothing lies behind it.
#define SWEEP_KEEP(k, weight) store(weight, weights[k], 0)
    SWEEP_WEIGH(real, SWEEP_KEEP, select_, f, n, above)
#undef SWEEP_KEEP
    for (int l = 0; l < LW_WIDTH; ++l) {
        float16 xy;
        float8 zz;
        float q[24];
        sweep_arriving(cells + corner[l], size, &weights[0][l], LW_WIDTH, &xy, &zz);
        vstore16(xy, 0, q);
        vstore8(zz, 2, q);
        for (int side = 0; side < LW_SWEEP_SIDES; ++side)
            for (int c = 0; c < LW_SWEEP_COLOURS; ++c) sides[side][c][l] = q[4 * side + c] / q[3];
    }
    lw_bands light;
    for (int c = 0; c < LW_SWEEP_COLOURS; ++c) {
        real sum = (real)0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const real towards = load(sides[2 * axis][c], 0), away = load(sides[2 * axis + 1][c], 0);
            sum += towards + away;
            light.c[1 + axis][c] = LW_BANDS_Y1 * (towards - away);
        }
        light.c[0][c] = sum * (M_1_PI_F / (6.0f * LW_BANDS_Y0));
    }
    const mask saturated = and_(store_layer(own, isCoarsest, light, harmonics, harmonicsLayout, band, x, y), shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}
