// Irradiance read from a light propagation volume (Kaplanyan and Dachsbacher 2010): the light half a cell in front of a
// surface, where what the surface itself sent was injected, interpolated and convolved with the cosine,
//   E(n) = k / s^2 max(0, LOBE0 c0 - LOBE1 (c1 . n)),
// light that travels along d lighting what faces -d. k: LpvPropagation::calibration. Here is where the light
// is clamped at 0, and only here.
//
// Damped, it is what is read a cell further off as well, where that is less: light that falls on a surface has come through
// the cells in front of it, and light that grows weaker away from it has come through the surface, or from it.
#include "shared/input_limits.h"
#include "shared/lpv_layer_bands.h"
#include "shared/lpv_layers.h"
#include "shared/lpv_types.h"
#include "shared/points.h"
#include "shared/surface.h"
#include "shared/wide.h"

#define LPV_LOBE0 0.8862269255f
#define LPV_LOBE1 1.0233267079f
// Floats of a cell in the order that pixels read: c0, c1.x, c1.y, c1.z of the three colours, and one unused, each.
#define LPV_CELL_FLOATS 16

// One work-item = one cell (x; y and z): planes to cells, so that a pixel finds all of a cell in one place. hasProgress: the light
// is that of as many steps as `progress` says.
__kernel void lpv_read_pack(__global const float* from, int size, __global const LwLpvProgress* progress, int hasProgress,
                            __global float* cells) {
    const int x = (int)get_global_id(0), line = (int)get_global_id(1);
    if (x >= size || line >= size * size) return;
    const int plane = lpv_plane(size);
    __global const float* p = from + lpv_cell(size, x, line % size, line / size);
    __global float* to = cells + LPV_CELL_FLOATS * (line * size + x);
    const float scale = hasProgress ? progress->scale : 1.0f;
    for (int band = 0; band < LW_LPV_BANDS; ++band) {
        for (int c = 0; c < LW_LPV_COLOURS; ++c) to[4 * band + c] = scale * p[(LW_LPV_BANDS * c + band) * plane];
        to[4 * band + 3] = 0.0f;
    }
}

// A coordinate in cells, from the first one's centre, to the lower of the two cells around it and the upper one's share. Beyond the
// outermost centres their light holds: the cells outside are empty because there are none.
LW_FN real split(real g, int size, lanei* lower) {
    const real inside = clamp(g, (real)0.0f, (real)(float)(size - 1));
    *lower = min(to_lanei(inside), (lanei)(size - 2));
    return inside - to_real(*lower);
}

// The corner (cell and its seven neighbours towards +) of one pixel.
LW_FN float16 interpolate(__global const float16* corner, int size, float x, float y, float z) {
    const int dz = size * size;
    float16 light = (float16)(0.0f);
    _Pragma("unroll") for (int k = 0; k < 8; ++k) {
        const float w = ((k & 1) ? x : 1.0f - x) * ((k & 2) ? y : 1.0f - y) * ((k & 4) ? z : 1.0f - z);
        light += w * corner[((k & 1) ? 1 : 0) + ((k & 2) ? size : 0) + ((k & 4) ? dz : 0)];
    }
    return light;
}

// Irradiance, not yet scaled, at a place in cells from the first one's centre; of colours in the first three lanes.
LW_FN float4 light_at(__global const float16* cells, int size, const float* at, float nx, float ny, float nz) {
    float share[3];
    int corner = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const float inside = clamp(at[axis], 0.0f, (float)(size - 1));
        const int lower = min((int)inside, size - 2);
        share[axis] = inside - (float)lower;
        corner = corner * size + lower;
    }
    const float16 v = interpolate(cells + corner, size, share[0], share[1], share[2]);
    return v.s0123 * LPV_LOBE0 - (v.s4567 * nx + v.s89ab * ny + v.scdef * nz) * LPV_LOBE1;
}

// Where surfaces read, in cells from the grid's corner: half a cell off; and which of them the grid has.
typedef struct {
    real x, y, z;
    mask has;
} lpv_reader;

LW_FN lpv_reader reader_of(const lw_surface s, const LwLpvPlace place, int size) {
    const float inverse = place.origin.w, most = (float)size;
    lpv_reader r;
    r.x = fma_(s.nx, (real)0.5f, (s.px - place.origin.x) * inverse);
    r.y = fma_(s.ny, (real)0.5f, (s.py - place.origin.y) * inverse);
    r.z = fma_(s.nz, (real)0.5f, (s.pz - place.origin.z) * inverse);
    const mask within = and_(and_(and_(r.x >= 0.0f, r.x <= most), and_(r.y >= 0.0f, r.y <= most)), and_(r.z >= 0.0f, r.z <= most));
    r.has = and_(s.valid, and_(within, splat_mask(inverse > 0.0f)));
    return r;
}

// The lower of the eight cells around each reader, and the upper ones' shares.
LW_FN lanei corner_of(const lpv_reader r, int size, real* fx, real* fy, real* fz) {
    const real none = (real)0.0f;
    lanei ix, iy, iz;
    *fx = split(select_(none, r.x - 0.5f, r.has), size, &ix);
    *fy = split(select_(none, r.y - 0.5f, r.has), size, &iy);
    *fz = split(select_(none, r.z - 0.5f, r.has), size, &iz);
    return (iz * size + iy) * size + ix;
}

// One work-item = LW_WIDTH pixels of a row. hasIrradiance, hasValidity: which are wanted; the other's arguments are not
// touched. Validity is 1 where the grid has the surface, 0 elsewhere, where irradiance is 0 as well. counts[0]: pixels that are
// neither surface nor background; counts[1]: whose light was brought down; counts[2]: surfaces that the grid does not have.
//
// grids: of `layers` nested ones this is number `layer` (shared/lpv_layers.h). All but the coarsest, the last, change irradiance alone.
__kernel void lpv_read_gather(__global const float* position, int4 positionLayout, __global const float* normal,
                            int4 normalLayout, int width, int height, __global const LwLpvPlace* grids, int layer, int layers, int size,
                            __global const float16* cells, float calibration, int isDamped, int hasIrradiance, int hasValidity,
                            __global float* irradiance, int4 irradianceLayout, __global float* validity, int4 validityLayout,
                            __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = grids[layer];
    const int isCoarsest = layer + 1 == layers;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask shown = lanei_iota() + x < width;
    const lpv_reader reader = reader_of(s, place, size);
    const mask has = reader.has;
    const float inverse = place.origin.w;

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

    const real none = (real)0.0f;
    const lpv_reader at = {reader.x, reader.y, reader.z, own.read};
    real fx, fy, fz;
    const lanei corners = corner_of(at, size, &fx, &fy, &fz);
    // Pixel by pixel: one load takes all of a cell, where lanes of pixels would gather every number alone.
    float px[LW_WIDTH], py[LW_WIDTH], pz[LW_WIDTH], nx[LW_WIDTH], ny[LW_WIDTH], nz[LW_WIDTH];
    float light[LW_LPV_COLOURS][LW_WIDTH];
    int corner[LW_WIDTH];
    store(fx, px, 0);
    store(fy, py, 0);
    store(fz, pz, 0);
    store(s.nx, nx, 0);
    store(s.ny, ny, 0);
    store(s.nz, nz, 0);
    store(corners, corner, 0);
    // All or none, as in lpv_sweep_gather.
    const int count = any_(own.read) ? LW_WIDTH : 0;
    for (int c = 0; c < LW_LPV_COLOURS; ++c) store(none, light[c], 0);
    for (int l = 0; l < count; ++l) {
        const float16 v = interpolate(cells + corner[l], size, px[l], py[l], pz[l]);
        float4 e = v.s0123 * LPV_LOBE0 - (v.s4567 * nx[l] + v.s89ab * ny[l] + v.scdef * nz[l]) * LPV_LOBE1;
        if (isDamped) {
            const int lower = corner[l];
            const float further[3] = {(float)(lower % size) + px[l] + nx[l], (float)(lower / size % size) + py[l] + ny[l],
                                      (float)(lower / (size * size)) + pz[l] + nz[l]};
            e = fmin(e, light_at(cells, size, further, nx[l], ny[l], nz[l]));
        }
        light[0][l] = e.x;
        light[1][l] = e.y;
        light[2][l] = e.z;
    }
    const int e = irradianceLayout.x + y * irradianceLayout.y + x;
    mask saturated = splat_mask(0);
    for (int c = 0; c < LW_LPV_COLOURS; ++c) {
        const int at = e + c * irradianceLayout.z;
        real coarser = none;
        if (!isCoarsest) coarser = load(irradiance, at);
        const real found = select_(none, fmax(load(light[c], 0), none) * calibration * inverse * inverse, own.read);
        const mask cut = and_(coarser >= LW_LARGEST_IRRADIANCE, own.share < 1.0f);
        saturated = or_(saturated, and_(own.read, or_(found > LW_LARGEST_IRRADIANCE, cut)));
        store(layered(own, coarser, fmin(found, (real)LW_LARGEST_IRRADIANCE)), irradiance, at);
    }
    saturated = and_(saturated, own.isLast);
    saturated = and_(saturated, shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}

// One work-item = LW_WIDTH points of a row: the light that arrives there, in two bands. A cell's is radiant intensity of light that
// travels along d; it arrives from -d, and calibration / s^2 times it is the radiance whose irradiance lpv_read_gather reads.
// Undamped: what is damped depends on the surface. Points without normals read where they are. hasHarmonics, hasValidity, validity
// and counts: as lpv_read_gather's.
__kernel void lpv_read_harmonics(__global const float* position, int4 positionLayout, __global const float* normal,
                                 int4 normalLayout, int hasNormals, int width, int height, __global const LwLpvPlace* grids, int layer,
                                 int layers, int size, __global const float16* cells, float calibration, int hasHarmonics, int hasValidity,
                                 __global float* harmonics, int4 harmonicsLayout, int band, __global float* validity,
                                 int4 validityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = grids[layer];
    const int isCoarsest = layer + 1 == layers;
    const lw_surface s = load_point(position, positionLayout, normal, normalLayout, hasNormals, x, y);
    const mask shown = lanei_iota() + x < width;
    const lpv_reader reader = reader_of(s, place, size);
    if (isCoarsest) {
        const mask missing = and_(and_(s.valid, not_(reader.has)), shown);
        if (any_(missing)) atomic_add(counts + 2, count_(missing));
        if (hasValidity) store(ones_(reader.has), validity, validityLayout.x + y * validityLayout.y + x);
    }
    if (!hasHarmonics) return;
    mask some = s.valid;
    if (isCoarsest) some = reader.has;
    const lpv_layer own = layer_of(grids, layer, layers, size, s.px, s.py, s.pz, some);
    if (!isCoarsest && !any_(and_(own.read, shown))) return;

    const lpv_reader at = {reader.x, reader.y, reader.z, own.read};
    real fx, fy, fz;
    const lanei corners = corner_of(at, size, &fx, &fy, &fz);
    float px[LW_WIDTH], py[LW_WIDTH], pz[LW_WIDTH], found[LPV_CELL_FLOATS][LW_WIDTH];
    int corner[LW_WIDTH];
    store(fx, px, 0);
    store(fy, py, 0);
    store(fz, pz, 0);
    store(corners, corner, 0);
    for (int l = 0; l < LW_WIDTH; ++l) {
        float v[LPV_CELL_FLOATS];
        vstore16(interpolate(cells + corner[l], size, px[l], py[l], pz[l]), 0, v);
        for (int k = 0; k < LPV_CELL_FLOATS; ++k) found[k][l] = v[k];
    }
    const float inverse = place.origin.w;
    lw_bands light;
    for (int b = 0; b < LW_LPV_BANDS; ++b)
        for (int c = 0; c < LW_LPV_COLOURS; ++c)
            light.c[b][c] = load(found[4 * b + c], 0) * (b == 0 ? calibration : -calibration) * inverse * inverse;
    const mask saturated = and_(store_layer(own, isCoarsest, light, harmonics, harmonicsLayout, band, x, y), shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}
