// From surfaces to the beginnings of cones: the frame of a normal, places in voxels, which grid a surface lies in.
#ifndef LW_CONE_SURFACE_H
#define LW_CONE_SURFACE_H

#include "cone_march.h"
#include "shared/surface.h"

// Of the frame that the sets of cones are counted in (Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017).
typedef struct { real x[3], y[3], z[3]; } cone_frame;

LW_FN void frame_of(cone_frame* f, const lw_surface* s) {
    const real one = (real)1.0f, sign = select_(one, -one, s->nz < 0.0f), a = -1.0f / (sign + s->nz), b = s->nx * s->ny * a;
    f->x[0] = fma_(sign * s->nx * s->nx, a, one);
    f->x[1] = sign * b;
    f->x[2] = -sign * s->nx;
    f->y[0] = b;
    f->y[1] = fma_(s->ny * s->ny, a, sign);
    f->y[2] = -s->ny;
    f->z[0] = s->nx;
    f->z[1] = s->ny;
    f->z[2] = s->nz;
}

LW_FN real turned(const cone_frame* f, int axis, float4 d) {
    return fma_(f->x[axis], (real)d.x, fma_(f->y[axis], (real)d.y, f->z[axis] * d.z));
}

LW_FN void volumes_of(cone_volume* v, const LwConeGrids grids, __global const int* table, __global const uint* base,
                      __global const uint* mips, __global const LwVoxelState* states) {
    for (int c = 0; c < LW_CONE_CASCADES; ++c) {
        v[c].grids = grids;
        v[c].table = table + c * grids.table;
        v[c].base = base;
        v[c].mips = mips;
        v[c].unit = states[c].unit;
    }
}

// Places of surfaces in each grid. true lanes: the outermost grid has them.
LW_FN mask origins_of(cone_origin* o, const lw_surface* s, __global const LwGridPlace* places, int size) {
    mask has = s->valid;
    for (int c = 0; c < LW_CONE_CASCADES; ++c) {
        const float4 at = places[c].origin;
        o->x[c] = (s->px - at.x) * at.w;
        o->y[c] = (s->py - at.y) * at.w;
        o->z[c] = (s->pz - at.z) * at.w;
        if (c == LW_CONE_CASCADES - 1)
            has = and_(has, and_(in_grid(o->x[c], o->y[c], o->z[c], 0.0f, (float)size), splat_mask(at.w > 0.0f)));
    }
    return has;
}

// The planes of surfaces that cones leave along d, on whichever side; none of lanes that do not `leave` one.
LW_FN void plane_of(cone_plane* p, const lw_surface* s, const cone_origin* o, real dx, real dy, real dz, mask leave) {
    const real along = fma_(s->nx, dx, fma_(s->ny, dy, s->nz * dz)), one = (real)1.0f, none = (real)0.0f;
    const real side = select_(none, select_(one, -one, along < none), leave);
    p->nx = side * s->nx;
    p->ny = side * s->ny;
    p->nz = side * s->nz;
    for (int c = 0; c < LW_CONE_CASCADES; ++c)
        p->at[c] = select_((real)LW_CONE_NO_PLANE, fma_(p->nx, o->x[c], fma_(p->ny, o->y[c], p->nz * o->z[c])), leave);
}

// Of the lanes `has` those whose finest grid is this one.
LW_FN mask own_lanes(const cone_origin* o, int grid, int size, mask has) {
    const float most = (float)size;
    mask own = has;
    for (int c = 0; c < LW_CONE_CASCADES; ++c) {
        if (c > grid) break;
        const mask in = in_grid(o->x[c], o->y[c], o->z[c], 0.0f, most);
        if (c < grid) own = and_(own, not_(in));
        else if (c < LW_CONE_CASCADES - 1) own = and_(own, in);
    }
    return own;
}

#endif
