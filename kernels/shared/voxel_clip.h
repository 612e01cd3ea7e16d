// How much of a facet lies in each voxel of a brick: cut exactly, by the planes between voxels (Sutherland and Hodgman 1974). Both
// sides of a cut get the same new vertices, so that areas of the parts add up to that of the whole.
#ifndef LW_VOXEL_CLIP_H
#define LW_VOXEL_CLIP_H

#include "voxel_facet.h"
#include "voxel_types.h"

// Each cut adds a vertex at most: a facet of 8, cut by a brick's six sides and by three planes more. A few to spare, should
// rounding bend a polygon inwards.
#define CLIP_VERTICES 24

typedef struct {
    int count;
    float p[CLIP_VERTICES][3];  // relative to the facet's base
} lw_polygon;

LW_FN int dominant_axis(const float* n) {
    return fabs(n[0]) >= fmax(fabs(n[1]), fabs(n[2])) ? 0 : fabs(n[1]) >= fabs(n[2]) ? 1 : 2;
}

LW_FN void polygon_of(const lw_facet* f, lw_polygon* g) {
    g->count = f->count;
    for (int i = 0; i < f->count; ++i)
        for (int a = 0; a < 3; ++a) g->p[i][a] = f->at[i][a];
}

// (Vertex by vertex: whole structs take longer, of what has just been written in parts.)
LW_FN void copy_polygon(const lw_polygon* from, lw_polygon* to) {
    to->count = from->count;
    for (int i = 0; i < from->count; ++i)
        for (int a = 0; a < 3; ++a) to->p[i][a] = from->p[i][a];
}

LW_FN void add_vertex(lw_polygon* to, const float* p) {
    if (to->count >= CLIP_VERTICES) return;
    for (int a = 0; a < 3; ++a) to->p[to->count][a] = p[a];
    ++to->count;
}

// Cuts at `at` along an axis: what lies below, and the rest. A vertex on the plane is both's.
LW_FN void cut_polygon(const lw_polygon* whole, int axis, float at, lw_polygon* below, lw_polygon* above) {
    below->count = above->count = 0;
    for (int i = 0; i < whole->count; ++i) {
        const float* p = whole->p[i];
        const float* q = whole->p[i + 1 < whole->count ? i + 1 : 0];
        if (p[axis] <= at) add_vertex(below, p);
        if (p[axis] >= at) add_vertex(above, p);
        if (!((p[axis] < at && q[axis] > at) || (p[axis] > at && q[axis] < at))) continue;
        const float t = (at - p[axis]) / (q[axis] - p[axis]);
        float between[3];
        for (int a = 0; a < 3; ++a) between[a] = a == axis ? at : p[a] + t * (q[a] - p[a]);
        add_vertex(below, between);
        add_vertex(above, between);
    }
}

// Twice the area as seen along an axis, from u to v.
LW_FN float polygon_area(const lw_polygon* g, int u, int v) {
    float sum = 0.0f;
    for (int i = 1; i + 1 < g->count; ++i)
        sum += (g->p[i][u] - g->p[0][u]) * (g->p[i + 1][v] - g->p[0][v]) - (g->p[i][v] - g->p[0][v]) * (g->p[i + 1][u] - g->p[0][u]);
    return fabs(sum);
}

LW_FN float polygon_low(const lw_polygon* g, int axis) {
    float low = g->p[0][axis];
    for (int i = 1; i < g->count; ++i) low = fmin(low, g->p[i][axis]);
    return low;
}

// Takes off what lies below `at`; nothing where all lies above, all where nothing does: what lies in the plane itself is above.
LW_FN void take_below(lw_polygon* rest, int axis, float at, lw_polygon* below) {
    int someBelow = 0, someAbove = 0;
    for (int i = 0; i < rest->count; ++i) {
        someBelow |= rest->p[i][axis] < at;
        someAbove |= rest->p[i][axis] > at;
    }
    below->count = 0;
    if (!someBelow) return;
    if (!someAbove) {
        copy_polygon(rest, below);
        rest->count = 0;
        return;
    }
    lw_polygon whole;
    copy_polygon(rest, &whole);
    cut_polygon(&whole, axis, at, below, rest);
}

LW_FN void keep_between(lw_polygon* g, int axis, float low, float high) {
    lw_polygon below;
    take_below(g, axis, low, &below);
    take_below(g, axis, high, &below);
    copy_polygon(&below, g);
}

// ------------------------------------------------------------------------------------------------- sums

// Of a voxel, whole numbers, so that their order does not matter: |n| A three times, A, n A, albedo A, emission A.
#define SURFACE_SUMS 13
// Of a face of a voxel. A plane cuts at most sqrt(2) faces out of a voxel, and there are at most 2^27.5 triangles (LW_TRIANGLE_PLANES
// floats of each below 2^31) or 2^24 surfels of 4 faces: sums stay below 2^62.
#define SURFACE_WHOLE 17179869184.0f  // 2^34

typedef struct {
    float n[3], albedo[3], emission[3];  // emission: relative to LwVoxelGrid's
    int emits;
} lw_coat;

LW_FN void add_area(float area, const lw_coat* coat, long* sum) {
    const float whole = area * SURFACE_WHOLE;
    sum[3] += (long)whole;
    for (int a = 0; a < 3; ++a) {
        const long part = (long)(whole * fabs(coat->n[a]));
        sum[a] += part;
        sum[4 + a] += coat->n[a] < 0.0f ? -part : part;
        sum[7 + a] += (long)(whole * coat->albedo[a]);
    }
    if (coat->emits)
        for (int a = 0; a < 3; ++a) sum[10 + a] += (long)(whole * coat->emission[a]);
}

// Where in a brick's layers of voxels the facet's parts end: the first voxel that the polygon reaches along an axis.
LW_FN int first_reached(const lw_polygon* g, int axis, float corner) { return (int)clamp(polygon_low(g, axis) - corner, 0.0f, 7.0f); }

// Adds the facet's area in each voxel of a brick, in the layers first .. last, to the voxels' sums (of the first such layer on).
LW_FN void fill_voxels(const lw_facet* f, const lw_coat* coat, const int* corner, int first, int last, long* sums) {
    if (!(f->area > 0.0f)) return;
    const int w = dominant_axis(f->n), u = w == 0 ? 1 : 0, v = w == 2 ? 1 : 2;
    lw_polygon g;
    polygon_of(f, &g);
    float low[3];
    for (int a = 0; a < 3; ++a) {
        low[a] = (float)corner[a] - f->base[a];
        // (By the whole brick, not by the layers: cuts, and what they round, are the same however a brick is shared out.)
        if (f->low[a] <= (float)corner[a] || f->high[a] >= (float)(corner[a] + LW_VOXEL_BRICK))
            keep_between(&g, a, low[a], (float)(corner[a] + LW_VOXEL_BRICK) - f->base[a]);
        if (g.count == 0) return;
    }
    const float unit = 0.5f / fabs(f->n[w]);
    int voxel[3];
    for (voxel[v] = first_reached(&g, v, low[v]); g.count && voxel[v] < LW_VOXEL_BRICK; ++voxel[v]) {
        lw_polygon row;
        take_below(&g, v, (float)(corner[v] + voxel[v] + 1) - f->base[v], &row);
        if (row.count == 0) continue;
        for (voxel[u] = first_reached(&row, u, low[u]); row.count && voxel[u] < LW_VOXEL_BRICK; ++voxel[u]) {
            lw_polygon cell;
            take_below(&row, u, (float)(corner[u] + voxel[u] + 1) - f->base[u], &cell);
            if (cell.count == 0) continue;
            for (voxel[w] = first_reached(&cell, w, low[w]); cell.count && voxel[w] < LW_VOXEL_BRICK; ++voxel[w]) {
                lw_polygon part;
                take_below(&cell, w, (float)(corner[w] + voxel[w] + 1) - f->base[w], &part);
                if (part.count == 0 || voxel[2] < first || voxel[2] > last) continue;
                add_area(polygon_area(&part, u, v) * unit, coat,
                         sums + SURFACE_SUMS * (voxel[0] + 8 * (voxel[1] + 8 * (voxel[2] - first))));
            }
        }
    }
}

#endif
