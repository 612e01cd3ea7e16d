// The light that arrives at points in two bands of spherical harmonics, from cones over the whole sphere, each of the same part of it:
//   c0 = 4 pi sum w Y0 L,  c1 = 4 pi sum w Y1 d L.
// Points with normals begin `nudge` voxels off their surface; those without where they are.
#include "cone_surface.h"
#include "shared/points.h"

// One work-item = LW_WIDTH points of a row. cones: `count`, their weights adding up to 1. harmonics: as store_bands; validity: weight of
// cones that begin inside the grid. counts[1]: points whose light was brought down; [2]: points that the grid does not have.
__kernel void cone_gather_harmonics(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                                    int hasNormals, int width, int height, __global const LwGridPlace* places, LwConeGrids grids,
                                    __global const int* table, __global const uint* base, __global const uint* mips,
                                    __global const LwVoxelState* states, __global const LwCone* cones, int count,
                                    __global const LwConeStep* steps, LwConeView view, int hasHarmonics, int hasValidity,
                                    __global float* harmonics, int4 harmonicsLayout, int band, __global float* validity,
                                    int4 validityLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_point(position, positionLayout, normal, normalLayout, hasNormals, x, y);
    const mask shown = lanei_iota() + (lanei)x < (lanei)width;
    cone_volume volumes[LW_CONE_CASCADES];
    volumes_of(volumes, grids, table, base, mips, states);
    cone_origin o;
    const mask has = and_(origins_of(&o, &s, places, grids.size), shown);
    const int last = LW_CONE_CASCADES - 1;
    const float most = (float)grids.size;
    lw_bands light;
    for (int b = 0; b < 4; ++b)
        for (int c = 0; c < 3; ++c) light.c[b][c] = (real)0.0f;
    real inside = (real)0.0f;
    for (int grid = 0; grid < LW_CONE_CASCADES; ++grid) {
        const mask own = own_lanes(&o, grid, grids.size, has);
        if (!any_(own)) continue;
        cone_origin from;
        for (int c = 0; c < LW_CONE_CASCADES; ++c) {
            const float off = view.rough.z * (float)(1 << grid) / (float)(1 << c);
            from.x[c] = fma_(s.nx, (real)off, o.x[c]);
            from.y[c] = fma_(s.ny, (real)off, o.y[c]);
            from.z[c] = fma_(s.nz, (real)off, o.z[c]);
        }
        const mask begun = and_(own, in_grid(from.x[last], from.y[last], from.z[last], 0.0f, most));
        for (int k = 0; k < count; ++k) {
            const LwCone cone = cones[k];
            const real dx = (real)cone.direction.x, dy = (real)cone.direction.y, dz = (real)cone.direction.z;
            // What goes down from a point off its surface meets that surface.
            cone_plane plane;
            plane_of(&plane, &s, &o, dx, dy, dz, and_(begun, fma_(s.nx, dx, fma_(s.ny, dy, s.nz * dz)) > 0.0f));
            cone_light l;
            l.r = l.g = l.b = l.occluded = (real)0.0f;
            l.through = (real)1.0f;
            march(&l, volumes, &from, grid, dx, dy, dz, steps + cone.first, cone.count, view.environment.w, (real)INFINITY, begun, &plane);
            const real share = ones_(begun) * cone.direction.w, rest = share * l.through;
            const real found[3] = {fma_(share, l.r, rest * view.environment.x), fma_(share, l.g, rest * view.environment.y),
                                   fma_(share, l.b, rest * view.environment.z)};
            const float y0 = 4.0f * M_PI_F * LW_BANDS_Y0, y1 = 4.0f * M_PI_F * LW_BANDS_Y1;
            for (int c = 0; c < 3; ++c) {
                light.c[0][c] = fma_(found[c], (real)y0, light.c[0][c]);
                light.c[1][c] = fma_(found[c], dx * y1, light.c[1][c]);
                light.c[2][c] = fma_(found[c], dy * y1, light.c[2][c]);
                light.c[3][c] = fma_(found[c], dz * y1, light.c[3][c]);
            }
            inside += share;
        }
    }
    if (hasValidity) store(fmin(inside, (real)1.0f), validity, validityLayout.x + y * validityLayout.y + x);
    if (hasHarmonics) {
        const mask saturated = and_(store_bands(light, has, harmonics, harmonicsLayout, band, x, y), shown);
        if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
    }
    const mask missing = and_(and_(s.valid, not_(has)), shown);
    if (any_(missing)) atomic_add(counts + 2, count_(missing));
}
