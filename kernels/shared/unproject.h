// World positions from depth, as src/inputs/camera.cpp describes them.
#ifndef LW_UNPROJECT_H
#define LW_UNPROJECT_H

#include "pixel_read.h"
#include "surface.h"
#include "unproject_types.h"

LW_FN real lw_linear(float4 c, real i, real j) { return fma_(c.x, i, fma_(c.y, j, c.w)); }

// Of LW_WIDTH pixels from (x, y) on. A pixel whose depth does not unproject to a point in front of the eye and within
// reach has no surface: it is not `there`, and its position is zero rather than garbage.
LW_FN LwTriple lw_unproject(const LwUnprojection u, real depth, int x, int y, mask* there) {
    const real i = lane_iota() + ((float)x + 0.5f), j = (real)((float)y + 0.5f);
    LwTriple p;
    p.x = lw_linear(u.x, i, j);
    p.y = lw_linear(u.y, i, j);
    p.z = lw_linear(u.z, i, j);
    mask valid = isfinite_(depth);
    if (u.mode == LW_UNPROJECT_HOMOGENEOUS) {
        const real high = fma_(u.w.x, i, fma_(u.w.y, j, fma_(u.w.z, depth, u.w.w)));
        const real w = high + fma_(u.wRest.z, depth, lw_linear(u.wRest, i, j));
        valid = and_(valid, w > 0.0f);
        p.x = fma_(u.x.z, depth, p.x) / w;
        p.y = fma_(u.y.z, depth, p.y) / w;
        p.z = fma_(u.z.z, depth, p.z) / w;
    } else {
        const real length = sqrt(fma_(p.x, p.x, fma_(p.y, p.y, p.z * p.z)));
        const real scale = u.mode == LW_UNPROJECT_RADIAL ? depth / length : depth;
        p.x *= scale;
        p.y *= scale;
        p.z *= scale;
    }
    if (u.positiveOnly) valid = and_(valid, depth > 0.0f);
    p.x += u.origin.x;
    p.y += u.origin.y;
    p.z += u.origin.z;
    *there = and_(valid, is_within_reach(p.x, p.y, p.z));
    p.x = select_((real)0.0f, p.x, *there);
    p.y = select_((real)0.0f, p.y, *there);
    p.z = select_((real)0.0f, p.z, *there);
    return p;
}

#endif
