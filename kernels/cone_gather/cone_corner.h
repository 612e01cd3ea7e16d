// Which eight voxels of a level lie around LW_WIDTH places, and their words two by two.
#ifndef LW_CONE_CORNER_H
#define LW_CONE_CORNER_H

#include "cone_plane.h"
#include "shared/voxel_format.h"
#include "shared/wide.h"

// The lower of the eight voxels around a place as a word of its plane, and the upper ones' shares. `side`: voxels a side of the level.
// `shared`: all lanes that have one have the same. `height`: of its centre before the plane that the cone leaves, in the level's voxels.
typedef struct {
    lanei at;
    real x, y, z;
#if LW_CONE_PLANE
    const cone_plane* plane;
    real height;
#endif
    mask has;
    int side, shared;
} cone_corner;

// at[l] and the word behind it: two voxels along x.
#if LW_WIDTH == 1
LW_FN void gather_pairs(__global const uint* words, lanei at, laneu* low, laneu* high) {
    *low = words[at];
    *high = words[at + 1];
}
#elif LW_WIDTH == 16 && defined(__AVX512F__) && defined(POCL_DEVICE_ADDRESS_BITS)
typedef long cone_long8 __attribute__((__vector_size__(64)));
typedef int cone_int8 __attribute__((__vector_size__(32)));
LW_FN void gather_pairs(__global const uint* words, lanei at, laneu* low, laneu* high) {
    const cone_long8 none = {0, 0, 0, 0, 0, 0, 0, 0};
    const void* from = (const void*)(size_t)words;
    const cone_long8 a = __builtin_ia32_gathersiv8di(none, from, __builtin_astype(at.lo, cone_int8), (unsigned char)255, 4);
    const cone_long8 b = __builtin_ia32_gathersiv8di(none, from, __builtin_astype(at.hi, cone_int8), (unsigned char)255, 4);
    const laneu x = __builtin_astype(a, laneu), y = __builtin_astype(b, laneu);
    *low = shuffle2(x, y, LW_EVEN);
    *high = shuffle2(x, y, LW_ODD);
}
#else
#define LW_GATHER_LOW(l) words[at.s##l]
#define LW_GATHER_HIGH(l) words[at.s##l + 1]
LW_FN void gather_pairs(__global const uint* words, lanei at, laneu* low, laneu* high) {
    *low = (laneu)LW_LANES(LW_GATHER_LOW);
    *high = (laneu)LW_LANES(LW_GATHER_HIGH);
}
#endif

// One instruction each, where fmin() and fmax() take five to look for NaN, and eight cycles one after the other.
LW_FN real lesser(real a, real b) { return select_(b, a, a < b); }
LW_FN real greater(real a, real b) { return select_(b, a, a > b); }

// A coordinate in cells from the first one's centre. Half a cell from the grid's border inwards the outermost voxels hold: those beyond
// are empty because there are none.
LW_FN real from_centre(real x, float scale, float most) {
    const real q = fmax(fma_(x, (real)scale, (real)-0.5f), (real)0.0f);
    return select_(q, (real)most, q > most);  // fmin() would look for NaN as well
}

// Where voxel i of a brick lies in it. (With & the compiler takes a product of 16 bits, at half the latency.)
LW_FN lanei in_brick(lanei ix, lanei iy, lanei iz) {
    return ((iz & 7) * LW_VOXEL_STORED + (iy & 7)) * LW_VOXEL_STORED + (ix & 7);
}

// LW_VOXEL_STRIDE, 23 * 32, times a slot, at less than half of a product's latency.
LW_FN lanei brick_at(lanei slot) { return (((slot << 4) + (slot << 3)) - slot) << 5; }

// Do the lanes `live` lie between the same voxels as lane 0? (Not where one lane is all there is: nothing would be saved.)
LW_FN int between_same(lanei ix, lanei iy, lanei iz, mask live) {
    const lanei key = ix + (iy << 10) + (iz << 20);
    return LW_WIDTH > 1 && !any_(and_(live, key != (lanei)firsti_lane(key)));
}

// x, y, z: in voxels of the finest level. table: of the level. at: the plane's in this grid. 0: no live lane has anything there.
LW_FN int find_corner(cone_corner* c, __global const int* table, int size, int level, real x, real y, real z, mask live,
                      const cone_plane* plane, real at) {
    const int side = size >> level;
    c->side = side;
    c->shared = LW_WIDTH > 1;
    if (side == 1) {  // all of the weights but the lower corner's are 0
        const int only = table[0];
        c->has = live;
        c->at = (lanei)(only * LW_VOXEL_STRIDE);
        c->x = c->y = c->z = (real)0.0f;
#if LW_CONE_PLANE
        c->plane = plane;
        c->height = fma_((real)0.5f, plane->nx + plane->ny + plane->nz, -at * as_float((127 - level) << 23));
#endif
        return only >= 0;
    }
    const float scale = as_float((127 - level) << 23), most = (float)(side - 1);
    const real qx = from_centre(x, scale, most), qy = from_centre(y, scale, most), qz = from_centre(z, scale, most);
    const lanei ix = to_lanei(qx), iy = to_lanei(qy), iz = to_lanei(qz);
    c->x = qx - to_real(ix);
    c->y = qy - to_real(iy);
    c->z = qz - to_real(iz);
#if LW_CONE_PLANE
    c->plane = plane;
    c->height = fma_(plane->nx, to_real(ix) + 0.5f, fma_(plane->ny, to_real(iy) + 0.5f, fma_(plane->nz, to_real(iz) + 0.5f, -at * scale)));
#endif
    const int bits = 28 - (int)clz(side);  // of bricks a side, above one
    if (between_same(ix, iy, iz, live)) {
        const int fx = firsti_lane(ix), fy = firsti_lane(iy), fz = firsti_lane(iz);
        const int slot = side <= LW_VOXEL_BRICK ? table[0] : table[((((fz >> 3) << bits) + (fy >> 3)) << bits) + (fx >> 3)];
        c->has = live;
        c->at = (lanei)(slot * LW_VOXEL_STRIDE + ((fz & 7) * LW_VOXEL_STORED + (fy & 7)) * LW_VOXEL_STORED + (fx & 7));
        return slot >= 0;
    }
    c->shared = 0;
    if (side <= LW_VOXEL_BRICK) {
        const int slot = table[0];
        c->has = live;
        c->at = in_brick(ix, iy, iz) + slot * LW_VOXEL_STRIDE;
        return slot >= 0;
    }
    const lanei slot = gatheri(table, ((((iz >> 3) << bits) + (iy >> 3)) << bits) + (ix >> 3));
    c->has = and_(live, slot >= (lanei)0);
    if (!any_(c->has)) return 0;
    c->at = brick_at(max(slot, (lanei)0)) + in_brick(ix, iy, iz);
    return 1;
}

#endif
