// How far an eye's light reaches surfaces past the voxels that things lie in, as voxel_visibility swept it.
#ifndef LW_VOXEL_SIGHT_H
#define LW_VOXEL_SIGHT_H

#include "shared/surface.h"
#include "shared/voxel_visibility_types.h"

// Lane l: byte p[i.l] and, times 256, the one after it.
#ifdef POCL_DEVICE_ADDRESS_BITS
typedef ushort lw_loose_pair __attribute__((aligned(1)));
#define LW_SIGHT_PAIR(p, i) ((int)*(__global const lw_loose_pair*)((p) + (i)))  // half the loads
#else
#define LW_SIGHT_PAIR(p, i) ((int)(p)[i] | (int)(p)[(i) + 1] << 8)
#endif
#if LW_WIDTH == 1
LW_FN lanei gather_pairs(__global const uchar* p, lanei i) { return LW_SIGHT_PAIR(p, i); }
#else
#define LW_SIGHT_LANE(l) LW_SIGHT_PAIR(p, i.s##l)
LW_FN lanei gather_pairs(__global const uchar* p, lanei i) { return (lanei)LW_LANES(LW_SIGHT_LANE); }
#endif

// Of a coordinate in voxels' centres: the lower of the two voxels that it lies between, and how far it is on to the upper one.
LW_FN lanei sight_cell(real at, int size, real* onward) {
    const real within = clamp(at, (real)0.0f, (real)((float)size - 1.0f));
    const lanei cell = min(to_lanei(within), (lanei)(size - 2));
    *onward = within - to_real(cell);
    return cell;
}

// Adds a voxel's weight, and as much of it as the eye's light does not reach it.
LW_FN void add_sight(real* sum, real* missing, real weight, lanei byte) {
    const mask isSolid = byte >= LW_SIGHT_SOLID;
    const real w = weight * select_((real)1.0f, (real)LW_SIGHT_SOLID_WEIGHT, isSolid);
    *sum += w;
    *missing = fma_(w, to_real(LW_SIGHT_FULL - (byte & LW_SIGHT_FULL)), *missing);
}

LW_FN mask outside_(real at, float size) { return or_(at < (real)0.0f, at > (real)size); }

// How far a way from the eye to a place goes before it leaves the grid along one axis, as a share of it.
LW_FN real share_inside(real at, float eye, float size) {
    const real far = at - eye, border = select_((real)0.0f, (real)size, far > (real)0.0f) - eye;
    return select_((real)1.0f, border / far, outside_(at, size));
}

// The share of the light of eye number `eye` that reaches the surfaces: of the eight voxels about the place one clearance off the
// surface, those that hold nothing count. 1 exactly where all of these are lit fully. Beyond the grid nothing is known to block:
// there counts what reaches the place where the light leaves it.
LW_FN real voxel_sight(__global const uchar* sights, __global const LwVoxelEye* eyes, __global const LwVoxelSight* grid, int eye,
                       const lw_surface s) {
    const float4 from = eyes[eye].position;
    if (from.w == 0.0f) return (real)1.0f;
    const int size = grid->size;
    const float4 origin = grid->origin;
    const real off = fabs(s.nx) + fabs(s.ny) + fabs(s.nz);
    real px = fma_(s.nx, off, (s.px - origin.x) * origin.w), py = fma_(s.ny, off, (s.py - origin.y) * origin.w),
         pz = fma_(s.nz, off, (s.pz - origin.z) * origin.w);
    const mask outside = or_(or_(outside_(px, (float)size), outside_(py, (float)size)), outside_(pz, (float)size));
    if (any_(outside)) {
        const real share = fmin(fmin(share_inside(px, from.x, (float)size), share_inside(py, from.y, (float)size)),
                                share_inside(pz, from.z, (float)size));
        px = select_(px, fma_(share, px - from.x, (real)from.x), outside);
        py = select_(py, fma_(share, py - from.y, (real)from.y), outside);
        pz = select_(pz, fma_(share, pz - from.z, (real)from.z), outside);
    }
    real tx, ty, tz;
    const lanei x = sight_cell(px - 0.5f, size, &tx), y = sight_cell(py - 0.5f, size, &ty), z = sight_cell(pz - 0.5f, size, &tz);
    __global const uchar* sight = sights + LW_SIGHT_PAD + (long)eye * size * size * size;
    const lanei first = x + size * (y + size * z);
    real sum = (real)0.0f, missing = (real)0.0f;
    LW_UNROLL for (int i = 0; i < 4; ++i) {
        const real w = ((i & 1) ? ty : 1.0f - ty) * ((i & 2) ? tz : 1.0f - tz);
        const lanei at = first + ((i & 1) * size + (i >> 1) * size * size);
        const lanei pair = gather_pairs(sight, at);
        add_sight(&sum, &missing, w * (1.0f - tx), pair & 255);
        add_sight(&sum, &missing, w * tx, pair >> 8);
    }
    return 1.0f - missing / ((float)LW_SIGHT_FULL * sum);
}

#endif
