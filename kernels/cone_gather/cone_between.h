// Between which voxels of a corner a place is interpolated, their shares and their words.
//
// LW_CONE_VOXELS: 8, or 4 (cone_volume.h). LW_CONE_PLANE 1: voxels before the plane that the cone leaves alone (cone_plane.h).
#ifndef LW_CONE_BETWEEN_H
#define LW_CONE_BETWEEN_H

#include "cone_corner.h"

#ifndef LW_CONE_VOXELS
#define LW_CONE_VOXELS 8
#endif

#define LW_CONE_X 1
#define LW_CONE_Y LW_VOXEL_STORED
#define LW_CONE_Z (LW_VOXEL_STORED * LW_VOXEL_STORED)

// Between which of a corner's voxels a place is interpolated, and their shares: all eight, or the four of the tetrahedron that it lies in:
// of the six along the way from the lower corner to the upper one the one that takes the axes by the place's shares, largest first.
typedef struct {
    real w[LW_CONE_VOXELS], sum;  // sum: as far as these are known, of w one after the other
#if LW_CONE_VOXELS == 4
    mask y, z, notZ;  // of x and y y is the larger; z is larger, and is not, than both
#endif
} cone_between;

#if LW_CONE_PLANE
// Of the shares those of voxels before the cone's plane, made to add up to `has` again.
LW_FN void keep_before(cone_between* b, const cone_corner* c, real has) {
    const real x = c->plane->nx, y = c->plane->ny, z = c->plane->nz;
    real sum = (real)0.0f;
    LW_UNROLL for (int k = 0; k < LW_CONE_VOXELS; ++k) {
#if LW_CONE_VOXELS == 4
        const real upper = x + y + z, first = select_(select_(x, y, b->y), z, b->z), last = select_(select_(y, x, b->y), z, b->notZ);
        const real step = k == 0 ? (real)0.0f : k == 1 ? first : k == 2 ? upper - last : upper;
#else
        const real step = ((k & 1) ? x : (real)0.0f) + ((k & 2) ? y : (real)0.0f) + ((k & 4) ? z : (real)0.0f);
#endif
        b->w[k] *= before_plane(c->plane, c->height + step);
        sum += b->w[k];
    }
    const real scale = has / greater(sum, (real)LW_CONE_PLANE_LEAST);
    b->sum = (real)0.0f;
    LW_UNROLL for (int k = 0; k < LW_CONE_VOXELS; ++k) {
        b->w[k] *= scale;
        b->sum += b->w[k];
    }
}
#endif

// has: the sum of the shares, 1 or 0.
LW_FN void between(cone_between* b, const cone_corner* c, real has) {
#if LW_CONE_VOXELS == 4
    const real x = c->x, y = c->y, z = c->z, high = greater(x, y), low = lesser(x, y);
    const real most = greater(high, z), least = lesser(low, z), middle = greater(low, lesser(high, z));
    b->y = x < y;
    b->z = z > high;
    b->notZ = z <= low;
    b->w[0] = has - most * has;
    b->w[1] = (most - middle) * has;
    b->w[2] = (middle - least) * has;
    b->w[3] = least * has;
#else
    const real upper = has * c->z, lower = has - upper;
    const real w3 = upper * c->y, w2 = upper - w3, w1 = lower * c->y, w0 = lower - w1;
    const real rows[4] = {w0, w1, w2, w3};
    LW_UNROLL for (int k = 0; k < 4; ++k) {
        b->w[2 * k + 1] = rows[k] * c->x;
        b->w[2 * k] = rows[k] - b->w[2 * k + 1];
    }
#endif
#if LW_CONE_PLANE
    keep_before(b, c, has);
#else
    b->sum = has;
#endif
}

// The words of those voxels, `at` the lower corner's.
LW_FN void load_words(laneu* found, __global const uint* words, lanei at, const cone_between* b) {
#if LW_CONE_VOXELS == 4
    __global const int* from = (__global const int*)words;
    const lanei x = (lanei)LW_CONE_X, y = (lanei)LW_CONE_Y, z = (lanei)LW_CONE_Z, upper = (lanei)(LW_CONE_X + LW_CONE_Y + LW_CONE_Z);
    found[0] = as_laneu_(gatheri(from, at));
    found[1] = as_laneu_(gatheri(from, at + selecti_(selecti_(x, y, b->y), z, b->z)));
    found[2] = as_laneu_(gatheri(from, at + (upper - selecti_(selecti_(y, x, b->y), z, b->notZ))));
    found[3] = as_laneu_(gatheri(from, at + upper));
#else
    LW_UNROLL for (int k = 0; k < 4; ++k)
        gather_pairs(words, at + ((k & 1) ? LW_CONE_Y : 0) + ((k & 2) ? LW_CONE_Z : 0), found + 2 * k, found + 2 * k + 1);
#endif
}

// The same where all lanes have one corner: each word is loaded once for all of them.
LW_FN void load_shared(laneu* found, __global const uint* words, const cone_between* b) {
#if LW_CONE_VOXELS == 4
    found[0] = (laneu)words[0];
    found[1] = selectu_(selectu_((laneu)words[LW_CONE_X], (laneu)words[LW_CONE_Y], b->y), (laneu)words[LW_CONE_Z], b->z);
    found[2] = selectu_(selectu_((laneu)words[LW_CONE_X + LW_CONE_Z], (laneu)words[LW_CONE_Y + LW_CONE_Z], b->y),
                        (laneu)words[LW_CONE_X + LW_CONE_Y], b->notZ);
    found[3] = (laneu)words[LW_CONE_X + LW_CONE_Y + LW_CONE_Z];
#else
    LW_UNROLL for (int k = 0; k < 8; ++k)
        found[k] = (laneu)words[((k & 1) ? LW_CONE_X : 0) + ((k & 2) ? LW_CONE_Y : 0) + ((k & 4) ? LW_CONE_Z : 0)];
#endif
}

#endif
