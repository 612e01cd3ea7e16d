// One cone through nested grids of voxels, front to back (Crassin et al. 2011): acc += (1 - acc.a) sample, premultiplied.
//
// LW_CONE_CASCADES: how many grids. LW_CONE_CORRECT 1: opacity follows the length of steps. LW_CONE_OPEN 1: ambient occlusion as well.
#ifndef LW_CONE_MARCH_H
#define LW_CONE_MARCH_H

#include "cone_volume.h"
#include "shared/grid_types.h"

#ifndef LW_CONE_CORRECT
#define LW_CONE_CORRECT 1
#endif
#ifndef LW_CONE_OPEN
#define LW_CONE_OPEN 0
#endif

typedef struct {
    real r, g, b;   // W/(sr m^2)
    real through;   // what still gets through
    real occluded;  // by the steps' dimming
    real before;    // opacity of the sample before
} cone_light;

// Where rays begin, in voxels from each grid's corner.
typedef struct {
    real x[LW_CONE_CASCADES], y[LW_CONE_CASCADES], z[LW_CONE_CASCADES];
} cone_origin;

LW_FN mask in_grid(real x, real y, real z, float low, float high) {
    return and_(and_(and_(x >= low, x <= high), and_(y >= low, y <= high)), and_(z >= low, z <= high));
}

#if LW_WIDTH == 1
LW_FN float greatest_lane(real v) { return v; }
#else
LW_FN float greatest_lane(real v) { LW_ACROSS(greater, v); }
#endif

// How far along d the grid reaches, in its voxels.
LW_FN real way_out(real at, real d, float size) {
    const real slow = (real)1e-20f, pace = select_(d, slow, fabs(d) < slow), inverse = 1.0f / pace;
    return greater(-at * inverse, (size - at) * inverse);
}

// Of a = 1 - t: 1 - t^e over a, for e > 0. log2 by 2 atanh(y) / ln 2, y = -a / (2 - a) after t's exponent is taken out, so that
// small opacities, most of them, keep their digits; powers of two by a polynomial. Both off by 2e-6 at most.
LW_FN real corrected(real a, float e) {
    const real t = 1.0f - a;
    const lanei bits = as_lanei_(t), exponent = (bits - 0x3f3504f3) >> 23;
    const real m = as_real_(bits - (exponent << 23)), y = (m - 1.0f) / (m + 1.0f), y2 = y * y;
    const real series = fma_(fma_(fma_(y2, (real)0.4121985f, (real)0.5770780f), y2, (real)0.9617967f), y2, (real)2.8853901f);
    const real power = e * fma_(y, series, to_real(exponent));
    // 2^power = 2^n (1 + f q), |f| <= 1/2.
    const real bounded = fmax(power, (real)-126.0f);
    const lanei n = to_lanei(bounded - 0.5f);
    const real f = bounded - to_real(n);
    const real q = fma_(fma_(fma_(fma_(fma_((real)1.5353362e-4f, f, (real)1.3398874e-3f), f, (real)9.6184373e-3f), f, (real)5.5503324e-2f), f,
                             (real)2.4022648e-1f), f, (real)6.9314718e-1f);
    const real whole = as_real_((n + 127) << 23), taken = (1.0f - whole) - whole * (f * q);
    const real ratio = select_(taken / a, (real)e, a < 1e-6f);
    return select_(ratio, (real)1.0f, t <= 0.0f);
}

// What one sample adds: `through` of the lanes that it counts for, 0 of the others.
//
// A wall between two samples is seen by both, as w and 1 - w of their cells: a layer that the one has part of is the one that the other has
// the rest of, not another one behind it, and what has got past the first has 1 - w left of which the second takes all. Multiplied
// as two layers w (1 - w) gets through. What is spread evenly has no layer: there samples multiply. So what counts of the one before is
// how closed this one's voxels are.
LW_FN void add_sample(cone_light* l, const cone_sample* s, const LwConeStep* step, float exponent, real through) {
    real weight = (real)1.0f;
#if LW_CONE_CORRECT
    if (exponent != 1.0f) weight *= corrected(s->a, exponent);
#endif
    const real alone = weight * s->a, left = greater(fma_(-s->spread, l->before, s->most), s->most * 1e-6f);
    weight *= through * s->most / greater(left, alone * s->most);
    l->before = select_((real)0.0f, alone, through > 0.0f);
    const real opacity = weight * s->a;
#if LW_CONE_LIGHT
    weight *= step->light;
    l->r = fma_(weight, s->r, l->r);
    l->g = fma_(weight, s->g, l->g);
    l->b = fma_(weight, s->b, l->b);
#endif
#if LW_CONE_OPEN
    l->occluded = fma_((real)step->dimming, opacity, l->occluded);
#endif
    l->through -= opacity;
}

// The corner of a step's place in grid c; 0: nothing there.
#if LW_CONE_CASCADES == 1
LW_FN int find_at(cone_corner* corner, const cone_volume* volumes, const cone_origin* from, int c, __global const LwConeStep* step, real dx,
                  real dy, real dz, mask live, real out, real far, const cone_plane* plane) {
    const real d = (real)step->distance;
    return find_corner(corner, volumes[c].table + volumes[c].grids.first[step->level], volumes[c].grids.size, step->level,
                       fma_(dx, d, from->x[c]), fma_(dy, d, from->y[c]), fma_(dz, d, from->z[c]), and_(live, and_(out >= step->begins, far >= d)), plane, plane->at[c]);
}
#endif

// grid: the one whose voxels the steps are counted in. reach, far: how far the cone reaches, all lanes and each, in voxels of the
// finest. live: the lanes that it is followed for. plane: of the surface that it leaves.
//
// Samples count as long as half of their cell lies before the ray's way out, and see what the grid's outermost cells hold: in a grid that
// is fitted to a room, walls are those, and the samples that they are interpolated between lie on both sides. Ending at the
// border, cones of 60 degrees lost half of the light of a closed box.
LW_FN void march(cone_light* l, const cone_volume* volumes, const cone_origin* from, int grid, real dx, real dy, real dz,
                 __global const LwConeStep* steps, int count, float reach, real far, mask live, const cone_plane* plane) {
    const int last = LW_CONE_CASCADES - 1, size = volumes[0].grids.size;
    l->before = (real)0.0f;
    const float most = (float)size, whole = (float)(1 << last);
    const real leaves = lesser(way_out(from->x[last], dx, most), lesser(way_out(from->y[last], dy, most), way_out(from->z[last], dz, most)));
    const real out = whole * leaves;
    // Steps up to where the last lane leaves the grid are known before there is any light: a count that the processor need not guess.
    const float end = greatest_lane(select_((real)-1.0f, out, live)), reaches = fmin(reach, greatest_lane(select_((real)-1.0f, far, live)));
#if LW_CONE_CASCADES == 1
    // The next sample's place and brick are looked for before this one's words, so that the one search does not wait for the other.
    cone_corner corner, next;
    int has = count > 0 && steps[0].begins <= end && find_at(&corner, volumes, from, 0, steps, dx, dy, dz, live, out, far, plane), nextHas;
    for (int i = 0; i < count; ++i, has = nextHas, corner = next) {
        const LwConeStep step = steps[i];
        if (step.begins > end || step.distance > reaches) break;
        nextHas = i + 1 < count && steps[i + 1].begins <= end && find_at(&next, volumes, from, 0, steps + i + 1, dx, dy, dz, live, out, far, plane);
        if (!has) {
            l->before = (real)0.0f;
            continue;
        }
        const mask lit = and_(corner.has, l->through > LW_CONE_LEAST);
        if (!any_(lit)) {
            l->before = (real)0.0f;
            continue;
        }
        cone_sample s;
        sample_corner(&s, volumes, step.level, &corner, dx, dy, dz);
        add_sample(l, &s, &step, step.exponent, select_((real)0.0f, l->through, lit));
    }
#else
    const float stretch = (float)(1 << grid);
    for (int i = 0; i < count; ++i) {
        const LwConeStep step = steps[i];
        const float distance = step.distance * stretch;
        if (step.begins * stretch > end || distance > reaches) break;
        live = and_(live, and_(and_(out >= step.begins * stretch, far >= distance), l->through > LW_CONE_LEAST));
        if (!any_(live)) break;
        // The finest grid that has all of the sample; the outermost one whatever it has.
        mask left = live;
        const int wanted = step.level + grid;
        const real before = l->before;
        real now = (real)0.0f;
        for (int c = 0; c < LW_CONE_CASCADES; ++c) {
            const int level = min(max(wanted - c, 0), volumes[c].grids.levels - 1);
            const float margin = 0.5f * (float)(1 << level);
            const real d = (real)(distance / (float)(1 << c));
            const real x = fma_(dx, d, from->x[c]), y = fma_(dy, d, from->y[c]), z = fma_(dz, d, from->z[c]);
            mask own = left;
            if (c < last) own = and_(left, in_grid(x, y, z, margin, most - margin));
            left = and_(left, not_(own));
            cone_corner corner;
            if (!any_(own) || !find_corner(&corner, volumes[c].table + volumes[c].grids.first[level], size, level, x, y, z, own, plane, plane->at[c])) continue;
            cone_sample s;
            sample_corner(&s, volumes + c, level, &corner, dx, dy, dz);
            // Of cells coarser than the cone the step is a smaller part.
            const float exponent = c > wanted ? step.exponent / (float)(1 << (c - wanted)) : step.exponent;
            l->before = before;
            add_sample(l, &s, &step, exponent, select_((real)0.0f, l->through, own));
            now += l->before;
        }
        l->before = now;
    }
#endif
    // What is closed takes all but a rounding, on either side.
    l->through = greater(l->through, (real)0.0f);
}

#endif
