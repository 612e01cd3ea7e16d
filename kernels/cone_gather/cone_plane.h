// The plane of the surface that a cone leaves. Where voxels are opaque from both sides, those that hold the surface itself would close
// the cone that leaves it: LW_CONE_PLANE 1: samples are interpolated between voxels that lie before the plane as a whole, and no others.
#ifndef LW_CONE_PLANE_H
#define LW_CONE_PLANE_H

#include "shared/wide.h"

#ifndef LW_CONE_CASCADES
#define LW_CONE_CASCADES 1
#endif
#ifndef LW_CONE_PLANE
#define LW_CONE_PLANE 0
#endif

// A voxel counts from where it no longer touches the plane, all of it once it is so far off, in its sides. Less: flat surfaces aslant to the
// grid show steps where a voxel begins to count; more: contacts are missed.
#define LW_CONE_PLANE_RAMP (1.0f / 16.0f)
// Of the weights of voxels that lie before the plane, together: less, and what is missing is taken to be empty, so that nothing jumps where
// the last of them goes.
#define LW_CONE_PLANE_LEAST (1.0f / 64.0f)

// Unit normal, towards the cone; and how far the plane lies from each grid's corner along it, in that grid's voxels. No plane: LW_CONE_NO_PLANE.
typedef struct {
    real nx, ny, nz;
    real at[LW_CONE_CASCADES];
} cone_plane;
#define LW_CONE_NO_PLANE (-1e6f)

// The share that counts of a voxel whose centre lies `height` of its sides before the plane.
LW_FN real before_plane(const cone_plane* p, real height) {
    const real touches = 0.5f * (fabs(p->nx) + fabs(p->ny) + fabs(p->nz));
    return clamp((height - touches) * (1.0f / LW_CONE_PLANE_RAMP), (real)0.0f, (real)1.0f);
}

#endif
