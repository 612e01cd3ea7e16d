// Irradiance at a view's pixels, or at a list of points, from a few cones through voxels (Crassin et al., Interactive Indirect
// Illumination Using Voxel Cone Tracing, 2011): all cones at each pixel, or a share of them at each pixel of a window, which
// cone_gather_filter puts together. docs/techniques/cone_gather.md.
#ifndef LW_CONE_ROWS
#define LW_CONE_ROWS 1  // of the window
#endif
#include "cone_deal.h"
#include "cone_surface.h"
#include "shared/input_limits.h"

#define LW_CONE_INTERLEAVED (LW_CONE_COLUMNS * LW_CONE_ROWS > 1)

// Sums over cones: weight times light, weight times what is open, weight of cones that begin inside.
typedef struct { real r, g, b, open, inside; } cone_sums;

LW_FN void trace_cones(cone_sums* sums, const lw_surface* s, const cone_volume* volumes, const cone_origin* o, mask has,
                       __global const LwCone* cones, int count, __global const LwConeStep* steps, const LwConeView* view) {
    cone_frame frame;
    frame_of(&frame, s);
    cone_plane plane;
    plane_of(&plane, s, o, s->nx, s->ny, s->nz, has);
    const int size = volumes[0].grids.size, last = LW_CONE_CASCADES - 1;
    for (int grid = 0; grid < LW_CONE_CASCADES; ++grid) {
        const mask own = own_lanes(o, grid, size, has);
        if (LW_CONE_CASCADES > 1 && !any_(own)) continue;
        for (int k = 0; k < count; ++k) {
            const LwCone cone = cones[k];
            const real dx = turned(&frame, 0, cone.direction), dy = turned(&frame, 1, cone.direction), dz = turned(&frame, 2, cone.direction);
            const real start = (real)(steps[cone.first].distance * (float)(1 << grid) / (float)(1 << last));
            const mask begun = and_(own, in_grid(fma_(dx, start, o->x[last]), fma_(dy, start, o->y[last]), fma_(dz, start, o->z[last]), 0.0f, (float)size));
            cone_light l;
            l.r = l.g = l.b = l.occluded = (real)0.0f;
            l.through = (real)1.0f;
            march(&l, volumes, o, grid, dx, dy, dz, steps + cone.first, cone.count, view->environment.w, (real)INFINITY, begun, &plane);
            const real share = ones_(begun) * cone.direction.w, rest = share * l.through;
            sums->r = fma_(share, l.r, fma_(rest, (real)view->environment.x, sums->r));
            sums->g = fma_(share, l.g, fma_(rest, (real)view->environment.y, sums->g));
            sums->b = fma_(share, l.b, fma_(rest, (real)view->environment.z, sums->b));
            sums->open = fma_(share, 1.0f - l.occluded, sums->open);
            sums->inside += share;
        }
    }
}

// One work-item = LW_WIDTH * LW_CONE_COLUMNS pixels of a row. cones: `perPixel` for each pixel of the window, row by row; their weights
// add up to 1 over all of it.
//
// Not interleaved: irradiance (3 planes, W/m^2), validity and open (1 plane each), those that are wanted by hasIrradiance ...
// Validity: the weight of cones that begin inside the grid, 1 or near it where the grid has the surface. Elsewhere all are 0.
// Interleaved: irradiance has 5 planes, the sums of weight times light, of the weight of cones that begin inside, and of all weight, 0
// without a surface; and with LW_CONE_OPEN a sixth, of weight times what is open.
// counts[0]: pixels that are neither surface nor background; [1]: whose light was brought down; [2]: surfaces that the grid does not have.
__kernel void cone_gather_trace(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                                int width, int height, __global const LwGridPlace* places, LwConeGrids grids, __global const int* table,
                                __global const uint* base, __global const uint* mips, __global const LwVoxelState* states,
                                __global const LwCone* cones, int perPixel, __global const LwConeStep* steps, LwConeView view,
                                int hasIrradiance, int hasValidity, int hasOpen, __global float* irradiance, int4 irradianceLayout,
                                __global float* validity, int4 validityLayout, __global float* open, int4 openLayout,
                                __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH * LW_CONE_COLUMNS, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int positionRow = positionLayout.x + y * positionLayout.y, normalRow = normalLayout.x + y * normalLayout.y;
    real p[3][LW_CONE_COLUMNS], n[3][LW_CONE_COLUMNS], out[6][LW_CONE_COLUMNS];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_cones(p[a], position, positionRow + a * positionLayout.z, x, width);
        load_cones(n[a], normal, normalRow + a * normalLayout.z, x, width);
    }
    cone_volume volumes[LW_CONE_CASCADES];
    volumes_of(volumes, grids, table, base, mips, states);
    const real none = (real)0.0f, most = (real)LW_LARGEST_IRRADIANCE;
    lanei rejected = (lanei)0, saturated = (lanei)0, missing = (lanei)0;
    for (int j = 0; j < LW_CONE_COLUMNS; ++j) {
        const lw_surface s = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        cone_origin o;
        const mask has = origins_of(&o, &s, places, grids.size);
        const int first = ((y % LW_CONE_ROWS) * LW_CONE_COLUMNS + j) * perPixel;
        cone_sums sums;
        sums.r = sums.g = sums.b = sums.open = sums.inside = none;
        if (any_(has)) trace_cones(&sums, &s, volumes, &o, has, cones + first, perPixel, steps, &view);
        real weight = none;
        for (int k = 0; k < perPixel; ++k) weight += cones[first + k].direction.w;
        const float toSum = LW_CONE_INTERLEAVED ? 1.0f : M_PI_F;
        const real r = sums.r * toSum, g = sums.g * toSum, b = sums.b * toSum;
        out[0][j] = fmin(r, most);
        out[1][j] = fmin(g, most);
        out[2][j] = fmin(b, most);
        out[3][j] = fmin(sums.inside, (real)1.0f);
        out[4][j] = select_(none, weight, s.valid);
        out[5][j] = fmin(sums.open, (real)1.0f);
        rejected += selecti_((lanei)0, (lanei)1, s.rejected);
        missing += selecti_((lanei)0, (lanei)1, and_(s.valid, not_(has)));
        saturated += selecti_((lanei)0, (lanei)1, and_(has, not_(fmax(r, fmax(g, b)) <= most)));
    }
#if LW_CONE_INTERLEAVED
    for (int a = 0; a < (LW_CONE_OPEN ? 6 : 5); ++a) store_cones(out[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
#else
    if (hasIrradiance)
        for (int a = 0; a < 3; ++a) store_cones(out[a], irradiance, irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y, x, width);
    if (hasOpen) store_cones(out[5], open, openLayout.x + y * openLayout.y, x, width);
    if (hasValidity) store_cones(out[3], validity, validityLayout.x + y * validityLayout.y, x, width);
#endif
    if (any_(to_mask(rejected))) atomic_add(counts, sum_(rejected));
    if (any_(to_mask(saturated))) atomic_add(counts + 1, sum_(saturated));
    if (any_(to_mask(missing))) atomic_add(counts + 2, sum_(missing));
}
