// Mip pyramid of a G-buffer and its direct light: each texel keeps position and normal of the child nearest the
// camera (Soler et al. 2009, section 4) and the mean radiance of the children on that surface; where it holds what they
// show as an area, too, it stands in the middle of that. Texel (i, j) of level k shows exactly the base pixels
// i 2^k .. (i+1) 2^k - 1, so nothing drifts from level to level; what of a last column or row lies beyond the image is no
// child. Among children at the same depth the first wins, and which is first changes from level to level (top left, bottom
// right): a wall facing the camera keeps points about its texels' centres.
#include "mip_pyramid.h"

typedef struct { real even, odd; } lw_pair;

// Columns x .. x + 2 LW_WIDTH - 1 of a row that may be read up to rowEnd; beyond, the first half again.
LW_FN lw_pair load_pair(__global const float* image, int row, int x, int rowEnd) {
    const real a = load_whole(image + row + x);
    const real b = load_whole(image + row + (x + LW_WIDTH < rowEnd ? x + LW_WIDTH : x));
    const lw_pair pair = {even_(a, b), odd_(a, b)};
    return pair;
}

LW_FN lw_texel empty_texel(void) {
    const real zero = (real)0.0f;
    const mask no = splat_mask(0);
    const lw_texel t = {{zero, zero, zero, zero, zero, zero, zero, no, no}, zero, zero, zero, zero, zero};
    return t;
}

// A pixel as the host gave it, checked. `inside`: of the image.
LW_FN lw_texel pixel_texel(real px, real py, real pz, real nx, real ny, real nz, real r, real g, real b, real receiveOnly,
                           mask inside, const LwPyramidCamera camera, int* rejected) {
    lw_texel t;
    const real zero = (real)0.0f;
    const mask outside = not_(inside);
    t.s = make_surface(px, py, pz, select_(nx, zero, outside), select_(ny, zero, outside), select_(nz, zero, outside));
    t.depth = axial_depth(t.s, camera);
    const mask sane = and_(and_(and_(r >= 0.0f, r <= LW_LARGEST_RADIANCE), and_(g >= 0.0f, g <= LW_LARGEST_RADIANCE)),
                           and_(b >= 0.0f, b <= LW_LARGEST_RADIANCE));
    const mask sends = and_(t.s.valid, and_(sane, receiveOnly == 0.0f));
    t.r = select_(zero, r, sends);
    t.g = select_(zero, g, sends);
    t.b = select_(zero, b, sends);
    const real area = pixel_area(t.s, t.depth, camera);
    t.area = select_(-area, area, sends);
    if (any_(t.s.rejected)) rejected[0] += count_(t.s.rejected);
    const mask bad = and_(t.s.valid, not_(sane));
    if (any_(bad)) rejected[1] += count_(bad);
    return t;
}

LW_FN void add_rejected(const int* rejected, __global int* counts) {
    if (rejected[0]) atomic_add(counts, rejected[0]);
    if (rejected[1]) atomic_add(counts + 1, rejected[1]);
}

#define LW_BASE_ARGUMENTS                                                                                              \
    __global const float *position, int4 positionLayout, __global const float *normal, int4 normalLayout,              \
        __global const float *radiance, int4 radianceLayout, __global const float *receiveMask, int4 receiveMaskLayout, \
        int hasMask, int width, int height, LwPyramidCamera camera, __global float *level, int4 levelLayout,           \
        __global int *counts

// One work-item = LW_WIDTH pixels: level 0, the base itself checked and with its normals at unit length.
// counts[0] grows by pixels that are neither surface nor background, counts[1] by surfaces whose radiance is not
// within 0 .. LW_LARGEST_RADIANCE.
__kernel void mip_pyramid_copy(LW_BASE_ARGUMENTS) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
    const real zero = (real)0.0f;
    real r = zero, g = zero, b = zero;
#if LW_PYRAMID_RADIANCE
    const int l = radianceLayout.x + y * radianceLayout.y + x;
    r = load(radiance, l);
    g = load(radiance, l + radianceLayout.z);
    b = load(radiance, l + 2 * radianceLayout.z);
#endif
    const real only = hasMask ? load(receiveMask, receiveMaskLayout.x + y * receiveMaskLayout.y + x) : zero;
    int rejected[2] = {0, 0};
    const lw_texel t = pixel_texel(load(position, p), load(position, p + positionLayout.z), load(position, p + 2 * positionLayout.z),
                                   load(normal, n), load(normal, n + normalLayout.z), load(normal, n + 2 * normalLayout.z), r, g, b,
                                   only, lanei_iota() + (lanei)x < (lanei)width, camera, rejected);
    store_texel(&t, level, levelLayout.x + y * levelLayout.y + x, levelLayout.z);
    add_rejected(rejected, counts);
}

#define LW_BASE_IMAGES position, positionLayout, normal, normalLayout, radiance, radianceLayout, receiveMask, receiveMaskLayout, hasMask

// LW_WIDTH texels of level 1 from column x of its row y on, of 2 x 2 pixels each.
LW_FN lw_texel half_texels(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                           __global const float* radiance, int4 radianceLayout, __global const float* receiveMask,
                           int4 receiveMaskLayout, int hasMask, int width, int height, const LwPyramidCamera camera, int x, int y,
                           int* rejected) {
    const int rowEnd = (width + 15) & ~15;
    const lanei column = lanei_iota() * 2 + (lanei)(2 * x);
    lw_texel child[4];  // round the block, so that a level may start with the corner across
    LW_UNROLL for (int j = 0; j < 2; ++j) {
        const int row = min(2 * y + j, height - 1);
        const mask rowInside = splat_mask(2 * y + j < height);
        lw_pair v[10];
        LW_UNROLL for (int a = 0; a < 3; ++a) {
            v[a] = load_pair(position, positionLayout.x + a * positionLayout.z + row * positionLayout.y, 2 * x, rowEnd);
            v[3 + a] = load_pair(normal, normalLayout.x + a * normalLayout.z + row * normalLayout.y, 2 * x, rowEnd);
            v[6 + a].even = v[6 + a].odd = (real)0.0f;
#if LW_PYRAMID_RADIANCE
            v[6 + a] = load_pair(radiance, radianceLayout.x + a * radianceLayout.z + row * radianceLayout.y, 2 * x, rowEnd);
#endif
        }
        v[9].even = v[9].odd = (real)0.0f;
        if (hasMask) v[9] = load_pair(receiveMask, receiveMaskLayout.x + row * receiveMaskLayout.y, 2 * x, rowEnd);
        child[3 * j] = pixel_texel(v[0].even, v[1].even, v[2].even, v[3].even, v[4].even, v[5].even, v[6].even, v[7].even, v[8].even,
                                   v[9].even, and_(rowInside, column < (lanei)width), camera, rejected);
        child[1 + j] = pixel_texel(v[0].odd, v[1].odd, v[2].odd, v[3].odd, v[4].odd, v[5].odd, v[6].odd, v[7].odd, v[8].odd,
                                       v[9].odd, and_(rowInside, column + 1 < (lanei)width), camera, rejected);
    }
    return merged(child, 0);
}

// One work-item = LW_WIDTH texels of level 1, from 2 x 2 pixels each; counts as above.
__kernel void mip_pyramid_base(LW_BASE_ARGUMENTS) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (2 * x >= width || 2 * y >= height) return;
    int rejected[2] = {0, 0};
    const lw_texel t = half_texels(LW_BASE_IMAGES, width, height, camera, x, y, rejected);
    store_texel(&t, level, levelLayout.x + y * levelLayout.y + x, levelLayout.z);
    add_rejected(rejected, counts);
}

// A child of level 2 as mip_pyramid_reduce would read it back: its depth is that of its place.
LW_FN lw_texel half_child(real px, real py, real pz, real nx, real ny, real nz, real r, real g, real b, real area,
                          const LwPyramidCamera camera) {
    lw_texel t = empty_texel();
    t.s.px = px;
    t.s.py = py;
    t.s.pz = pz;
    t.s.nx = nx;
    t.s.ny = ny;
    t.s.nz = nz;
    t.s.valid = squared_length(nx, ny, nz) > 0.25f;
    t.r = r;
    t.g = g;
    t.b = b;
    t.area = area;
    t.depth = axial_depth(t.s, camera);
    return t;
}

// One work-item = LW_WIDTH texels of level 2, from 4 x 4 pixels each: to the bit what mip_pyramid_base and mip_pyramid_reduce
// make of them one after the other, without level 1 in memory. counts as above.
__kernel void mip_pyramid_quarter(LW_BASE_ARGUMENTS) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (4 * x >= width || 4 * y >= height) return;
    int rejected[2] = {0, 0};
    lw_texel child[4];
    // What the next work-item reads: without, it waits for memory first.
    for (int j = 0; j < 4; ++j) {
        const int row = min(4 * y + j, height - 1), next = 4 * (x + LW_WIDTH);
        LW_UNROLL for (int a = 0; a < 3; ++a)
            LW_UNROLL for (int i = 0; i < 4; ++i) {
                will_load(position + positionLayout.x + a * positionLayout.z + row * positionLayout.y + next + i * LW_WIDTH);
                will_load(normal + normalLayout.x + a * normalLayout.z + row * normalLayout.y + next + i * LW_WIDTH);
#if LW_PYRAMID_RADIANCE
                will_load(radiance + radianceLayout.x + a * radianceLayout.z + row * radianceLayout.y + next + i * LW_WIDTH);
#endif
            }
    }
    for (int j = 0; j < 2; ++j) {
        // The second half may lie beyond the image: pixels there are none, and none are read.
        lw_texel t[2];
        LW_UNROLL for (int i = 0; i < 2; ++i) {
            if (2 * (2 * x + i * LW_WIDTH) < width && 2 * (2 * y + j) < height)
                t[i] = half_texels(LW_BASE_IMAGES, width, height, camera, 2 * x + i * LW_WIDTH, 2 * y + j, rejected);
            else
                t[i] = empty_texel();
        }
#define LW_CHILD(half) \
    half_child(half(t[0].s.px, t[1].s.px), half(t[0].s.py, t[1].s.py), half(t[0].s.pz, t[1].s.pz), half(t[0].s.nx, t[1].s.nx), \
               half(t[0].s.ny, t[1].s.ny), half(t[0].s.nz, t[1].s.nz), half(t[0].r, t[1].r), half(t[0].g, t[1].g), \
               half(t[0].b, t[1].b), half(t[0].area, t[1].area), camera)
        child[3 * j] = LW_CHILD(even_);
        child[1 + j] = LW_CHILD(odd_);
#undef LW_CHILD
    }
    const lw_texel t = merged(child, 2);
    store_texel(&t, level, levelLayout.x + y * levelLayout.y + x, levelLayout.z);
    add_rejected(rejected, counts);
}

LW_FN void replace_texel(lw_texel* t, const lw_texel* by, mask where) {
    t->s.px = select_(t->s.px, by->s.px, where);
    t->s.py = select_(t->s.py, by->s.py, where);
    t->s.pz = select_(t->s.pz, by->s.pz, where);
    t->s.nx = select_(t->s.nx, by->s.nx, where);
    t->s.ny = select_(t->s.ny, by->s.ny, where);
    t->s.nz = select_(t->s.nz, by->s.nz, where);
    t->s.valid = or_(and_(t->s.valid, not_(where)), and_(by->s.valid, where));
    t->r = select_(t->r, by->r, where);
    t->g = select_(t->g, by->g, where);
    t->b = select_(t->b, by->b, where);
    t->depth = select_(t->depth, by->depth, where);
}

// Child k is kept wherever it lies; where it shows no surface no other counts either.
LW_FN void keep_sample(lw_texel* child, const int k) {
    const mask valid = child[k].s.valid;
    child[k].depth = (real)-MAXFLOAT;
    child[k].s.nx = select_((real)0.0f, child[k].s.nx, valid);
    child[k].s.ny = select_((real)0.0f, child[k].s.ny, valid);
    child[k].s.nz = select_((real)0.0f, child[k].s.nz, valid);
    LW_UNROLL for (int i = 0; i < 4; ++i) child[i].s.valid = and_(child[i].s.valid, valid);
}

// One work-item = LW_WIDTH texels of a level, from 2 x 2 of the finer one. width, height: the finer level's size.
// first: which child is first among equals, round the block from 0 (top left) to 2 (bottom right). sampled: that child is kept wherever it lies,
// and where it shows no surface neither does the texel.
__kernel void mip_pyramid_reduce(__global const float* fine, int4 fineLayout, int width, int height, __global float* level,
                                 int4 levelLayout, LwPyramidCamera camera, int first, int sampled) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (2 * x >= width || 2 * y >= height) return;
    lw_texel child[4];
    LW_UNROLL for (int j = 0; j < 2; ++j) {
        const int inside = 2 * y + j < height;
        const int at = fineLayout.x + min(2 * y + j, height - 1) * fineLayout.y + 2 * x;
        lw_pair v[LW_PYRAMID_PLANES];
        LW_UNROLL for (int a = 0; a < LW_PYRAMID_PLANES; ++a) v[a] = load_pair(fine, at + a * fineLayout.z, 0, 2 * LW_WIDTH);
        LW_UNROLL for (int i = 0; i < 2; ++i) {
            lw_texel t = empty_texel();
            t.s.px = i ? v[0].odd : v[0].even;
            t.s.py = i ? v[1].odd : v[1].even;
            t.s.pz = i ? v[2].odd : v[2].even;
            t.s.nx = i ? v[3].odd : v[3].even;
            t.s.ny = i ? v[4].odd : v[4].even;
            t.s.nz = i ? v[5].odd : v[5].even;
            t.s.valid = and_(splat_mask(inside), squared_length(t.s.nx, t.s.ny, t.s.nz) > 0.25f);
#if LW_PYRAMID_RADIANCE
            t.r = i ? v[6].odd : v[6].even;
            t.g = i ? v[7].odd : v[7].even;
            t.b = i ? v[8].odd : v[8].even;
#endif
#if LW_PYRAMID_AREA
            t.area = i ? v[6 + 3 * LW_PYRAMID_RADIANCE].odd : v[6 + 3 * LW_PYRAMID_RADIANCE].even;
#endif
            t.depth = axial_depth(t.s, camera);
            child[j ? 3 - i : i] = t;
        }
    }
    if (sampled) {
        // Children beyond the image stand for those at its edge: a block that the edge cuts would else show nothing.
        if (2 * y + 1 >= height) {
            child[2] = child[1];
            child[3] = child[0];
        }
        const mask beyond = lanei_iota() * 2 + (lanei)(2 * x + 1) >= (lanei)width;
        if (any_(beyond)) {
            replace_texel(&child[1], &child[0], beyond);
            replace_texel(&child[2], &child[3], beyond);
        }
        if (first == 0) keep_sample(child, 0);
        else if (first == 1) keep_sample(child, 1);
        else if (first == 2) keep_sample(child, 2);
        else keep_sample(child, 3);
    }
    const lw_texel t = first == 0 ? merged(child, 0) : first == 1 ? merged(child, 1) : first == 2 ? merged(child, 2) : merged(child, 3);
    store_texel(&t, level, levelLayout.x + y * levelLayout.y + x, levelLayout.z);
}
