// A convex piece of a plane (a triangle; the octagon of a disc's area) in a grid of voxels: which voxels it touches, and how much of
// it lies in each. Derivations and bounds of the rounding: docs/techniques/voxel_grid.md.
//
// Lengths are voxels' sides. Vertices are relative to the first one, so that what rounds is as small as the facet; where the first
// one lies in the grid, `base`, rounds with its distance from the grid's corner.
#ifndef LW_VOXEL_FACET_H
#define LW_VOXEL_FACET_H

#include "wide.h"

#define FACET_VERTICES 8
// Bounds of what rounds, as shares: of a coordinate that is a difference times a scale (two roundings: 2^-23); of sums of products
// of differences. Less: voxels that a facet only just touches may be missed; more: voxels beside it are taken for touched.
#define FACET_PLACE_ERROR 1.5e-7f
#define FACET_ERROR 4.8e-7f
#define FACET_FARTHEST 256.0f  // coordinate of a voxel

typedef struct {
    int count;                      // of vertices
    float at[FACET_VERTICES][3];    // relative to base
    float base[3], low[3], high[3]; // low, high: bounds, from the grid's corner
    float n[3], area;               // unit normal, or 0 where the area is too small for one
} lw_facet;

// Bounds, of the vertices that are there.
LW_FN void bound_facet(lw_facet* f) {
    for (int a = 0; a < 3; ++a) {
        float low = f->at[0][a], high = low;
        for (int i = 1; i < f->count; ++i) {
            low = fmin(low, f->at[i][a]);
            high = fmax(high, f->at[i][a]);
        }
        f->low[a] = f->base[a] + low;
        f->high[a] = f->base[a] + high;
    }
}

// Of a triangle: its normal and area.
LW_FN void orient_facet(lw_facet* f) {
    float most = 0.0f;
    for (int a = 0; a < 3; ++a) most = fmax(most, fmax(fabs(f->at[1][a]), fabs(f->at[2][a])));
    const float unit = most > 0.0f ? 1.0f / most : 0.0f;  // products of small ones would fall below float's range
    const float ux = f->at[1][0] * unit, uy = f->at[1][1] * unit, uz = f->at[1][2] * unit;
    const float vx = f->at[2][0] * unit, vy = f->at[2][1] * unit, vz = f->at[2][2] * unit;
    const float x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const float length = sqrt(x * x + y * y + z * z), inverse = length > 0.0f ? 1.0f / length : 0.0f;
    f->n[0] = x * inverse;
    f->n[1] = y * inverse;
    f->n[2] = z * inverse;
    f->area = 0.5f * length * most * most;
}

// The voxels that its bounds reach along each axis, those included that rounding might; of how many axes these are several. 3 as
// well where not all of it lies where the grid may be.
LW_FN int facet_spans(const lw_facet* f, int* from, int* to) {
    int spans = 0;
    for (int a = 0; a < 3; ++a) {
        const float low = f->low[a] * (1.0f - FACET_PLACE_ERROR), high = f->high[a] * (1.0f + FACET_PLACE_ERROR);
        if (!(low > 0.0f && high < 65536.0f)) return 3;
        from[a] = (int)low;
        if ((float)from[a] == low) --from[a];  // a side that two voxels share is both's
        to[a] = (int)high;
        spans += from[a] != to[a];
    }
    return spans;
}

// ------------------------------------------------------------------------------------------ what it touches

// An axis that may separate voxels from the facet: the voxels with centres c where low <= x c_x + y c_y + z c_z <= high are not
// separated. Their own half extent and what rounds are within.
typedef struct {
    float x, y, z, low, high;
} lw_slab;

// n: a direction (its own error, each component: error); the interval that vertices fill along it, widened by the voxels' half extent
// and by the errors.
LW_FN void slab_of(const lw_facet* f, const float* n, const float* error, lw_slab* slab) {
    float low = 0.0f, high = 0.0f, base = 0.0f, wider = 0.0f;
    for (int i = 1; i < f->count; ++i) {
        const float d = n[0] * f->at[i][0] + n[1] * f->at[i][1] + n[2] * f->at[i][2];
        low = fmin(low, d);
        high = fmax(high, d);
    }
    for (int a = 0; a < 3; ++a) {
        const float reach = f->high[a] - f->low[a] + 1.0f, size = fabs(n[a]);
        base += n[a] * f->base[a];
        wider += size * (0.5f + FACET_ERROR * (fabs(f->base[a]) + FACET_FARTHEST + reach)) + error[a] * reach;
    }
    slab->x = n[0];
    slab->y = n[1];
    slab->z = n[2];
    slab->low = base + low - wider;
    slab->high = base + high + wider;
}

#define FACET_SLABS (1 + 3 * FACET_VERTICES / 2)

// The plane, then the edges' crosses with the axes. Of an octagon opposite edges are parallel. (Bounds are left to the caller.)
LW_FN int facet_slabs(const lw_facet* f, lw_slab* slabs) {
    float n[3], error[3], d[3];
    int count = 0;
    for (int a = 0; a < 3; ++a) d[a] = f->high[a] - f->low[a];
    const float most = fmax(d[0], fmax(d[1], d[2]));
    if (most > 0.0f && f->area > 0.0f) {
        // Of unit length a normal's error grows as the facet becomes a sliver: that of the cross product over its length.
        const float share = FACET_ERROR / (2.0f * f->area);
        for (int a = 0; a < 3; ++a) error[a] = share * (d[(a + 1) % 3] * d[(a + 2) % 3]) + FACET_ERROR * fabs(f->n[a]);
        slab_of(f, f->n, error, &slabs[count++]);
    }
    const int edges = f->count == 3 ? 3 : f->count / 2;
    for (int i = 0; i < edges; ++i)
        for (int a = 0; a < 3; ++a) {
            const int u = (a + 1) % 3, v = (a + 2) % 3, next = (i + 1) % f->count;
            n[a] = 0.0f;
            n[u] = -(f->at[next][v] - f->at[i][v]);
            n[v] = f->at[next][u] - f->at[i][u];
            error[a] = 0.0f;
            error[u] = FACET_ERROR * fabs(n[u]);
            error[v] = FACET_ERROR * fabs(n[v]);
            slab_of(f, n, error, &slabs[count++]);
        }
    return count;
}

// The voxels that the facet touches of a brick whose first voxel is `corner`, a bit each, in its layers first .. last (within
// 0 .. 7): or-ed into `words`, those of the layers.
LW_FN void touch_voxels(const lw_facet* f, const int* corner, int first, int last, uint* words) {
    int from[3], to[3];
    for (int a = 0; a < 3; ++a) {
        const float error = FACET_PLACE_ERROR * fmax(fabs(f->low[a]), fabs(f->high[a]));
        const float low = f->low[a] - error - (float)corner[a], high = f->high[a] + error - (float)corner[a];
        if (!(low <= 8.0f && high >= 0.0f)) return;
        from[a] = low <= 0.0f ? 0 : min((int)low, 7);
        to[a] = high >= 8.0f ? 7 : (int)high;
    }
    from[2] = max(from[2], first);
    to[2] = min(to[2], last);
    lw_slab slabs[FACET_SLABS];
    const int count = facet_slabs(f, slabs);
    for (int z = from[2]; z <= to[2]; ++z)
        for (int i = from[1] * 8 / LW_WIDTH * LW_WIDTH; i < (to[1] + 1) * 8; i += LW_WIDTH) {
            const lanei lane = lanei_iota() + (lanei)(i), ix = lane & (lanei)(7), iy = lane >> (lanei)(3);
            mask touched = and_(and_(ix >= (lanei)(from[0]), ix <= (lanei)(to[0])), and_(iy >= (lanei)(from[1]), iy <= (lanei)(to[1])));
            const real x = to_real(ix) + (real)((float)corner[0] + 0.5f), y = to_real(iy) + (real)((float)corner[1] + 0.5f);
            const float cz = (float)(corner[2] + z) + 0.5f;
            for (int s = 0; s < count && any_(touched); ++s) {
                const real d = slabs[s].x * x + slabs[s].y * y + (real)(slabs[s].z * cz);
                touched = and_(touched, and_(d >= (real)(slabs[s].low), d <= (real)(slabs[s].high)));
            }
            words[2 * (z - first) + (i >> 5)] |= bits_(touched) << (i & 31);
        }
}

#endif
