// A triangle as samples on a grid's lattice, LPV_RASTER to a cell's side each way, seen along the triangle's dominant axis. A surface
// that spans a cell has all of the cell's samples, whatever its triangles, and no chance: each sample on an edge belongs to one of the
// two triangles there. Surfels drawn by area would have to be as dense in all of the scene as the finest grid wants them.
//
// Nothing here knows where a grid lies that begins at a whole cell of the world: a sample that two grids have is decided alike in both,
// to the bit, so that a grid that moves on keeps what stays in it. As rasterisers do (Pineda 1988), vertices are rounded to a fraction
// of a sample and edges' functions are whole numbers: exact, or a sample beside a vertex could be in none of the triangles there.
#ifndef LW_LPV_RASTER_H
#define LW_LPV_RASTER_H

#include "geometry_types.h"
#include "lpv_scroll.h"
#include "wide.h"  // no contraction: both triangles of an edge must find the same number

// Less: surfaces that end within a cell count by quarters of it or more. More: time, with the square.
#define LPV_RASTER 4
// Of a sample, which vertices are rounded to. Fewer: surfaces' edges move; more: reach.
#define LPV_STEPS 256
// Samples from the lattice's origin within which they are: products of two differences of so many steps stay below 2^60. Edges to
// vertices farther off are told by floats, which have no more than a quarter of a sample there.
#define LPV_EXACT 2097152.0f
// Beyond the samples in a part's cells, those that may count there: area lies half a cell behind its surface, or at a corner half a
// cell off. One more for rounding.
#define LPV_BESIDE (LPV_RASTER / 2 + 1)

typedef struct {
    long at, stepU, stepV;  // of sample (0, 0): not below 0 on the triangle's side
    float from[2], to[2];   // its ends, the lower one first
    int isFar, isAbove;     // told by floats; whether the triangle lies where they are positive
} lpv_edge;

typedef struct {
    float at[3][3];  // vertices, in samples of the lattice
    lpv_edge edges[3];
    float nx, ny, nz;      // unit normal
    float area;            // of one sample, in sides of a cell
    float slopeU, slopeV;  // of the height along the axis
    int axis, u, v;        // the dominant axis, and the other two
    int isFar;             // some edge is
    int firstU, lastU, firstV, lastV;  // samples of a part that may lie in it; last below first: none does
} lpv_raster;

LW_FN int whole_below(float x) {  // (PoCL's floor takes long.)
    const int towards = (int)x;
    return towards - ((float)towards > x ? 1 : 0);
}

// The first sample of a part of a grid that may count there, and the first beyond.
LW_FN int samples_from(const lpv_lattice* lattice, lw_int4 low, int a) {
    return LPV_RASTER * (lattice->corner[a] + (a == 0 ? low.x : a == 1 ? low.y : low.z)) - LPV_BESIDE;
}
LW_FN int samples_to(const lpv_lattice* lattice, lw_int4 high, int a) {
    return LPV_RASTER * (lattice->corner[a] + (a == 0 ? high.x : a == 1 ? high.y : high.z)) + LPV_BESIDE;
}

// Of LW_WIDTH children of a node of the tree over the triangles, from `child` on, a bit each: leaves that reach a part. (Boxes are wider
// than what they hold by more than rounding.)
LW_FN uint raster_leaves(__global const float* node, int child, const lpv_lattice* lattice, float scale, lw_int4 low, lw_int4 high) {
    mask isNear = loadi((__global const int*)node, LW_TREE_COUNT + child) > 0;
    for (int a = 0; a < 3; ++a) {
        const float first = (float)samples_from(lattice, low, a), beyond = (float)samples_to(lattice, high, a), from = lattice->from[a];
        const real centre = (load(node, LW_TREE_CHILDREN * a + child) - from) * scale,
                   extent = load(node, LW_TREE_HALF + LW_TREE_CHILDREN * a + child) * scale;
        isNear = and_(isNear, and_(centre + extent >= first, centre - extent <= beyond));
    }
    return bits_(isNear);
}

// Of LW_WIDTH triangles from t on a bit each: those that reach a part and may have samples there. Without samples along two axes there
// are none seen along any: most triangles are that small.
LW_FN uint raster_near(__global const float* triangles, int stride, int t, const lpv_lattice* lattice, float scale, lw_int4 low, lw_int4 high) {
    mask isNear = splat_mask(1);
    lanei spans = (lanei)(0);
    for (int a = 0; a < 3; ++a) {
        const float from = lattice->from[a];
        const float first = (float)samples_from(lattice, low, a), beyond = (float)samples_to(lattice, high, a);
        const real p = (load(triangles, (LW_TRIANGLE_A + a) * stride + t) - from) * scale,
                   q = (load(triangles, (LW_TRIANGLE_B + a) * stride + t) - from) * scale,
                   s = (load(triangles, (LW_TRIANGLE_C + a) * stride + t) - from) * scale;
        const real least = fmin(fmin(p, q), s), most = fmax(fmax(p, q), s);
        isNear = and_(isNear, and_(most >= first, least <= beyond));
        // The last sample below the upper end, if it lies above the lower one; ends rounded to steps may lie one farther out.
        const float rounding = 2.0f / (float)LPV_STEPS;
        const real upper = fmin(most, (real)(beyond)) - first - (0.5f - rounding), lower = fmax(least, (real)(first)) - first - (0.5f + rounding);
        const mask some = and_(upper >= 0.0f, to_real(to_lanei(fmax(upper, (real)(0.0f)))) >= lower);
        spans += selecti_((lanei)(0), (lanei)(1), some);
    }
    return bits_(and_(isNear, spans >= 2));
}

// The edge from vertex a to b, with the triangle on its left seen in (u, v): turn is 1, or -1 with it on its right.
LW_FN void raster_edge(const lpv_raster* r, int (*whole)[3], int a, int b, int turn, lpv_edge* edge) {
    const float au = r->at[a][r->u], av = r->at[a][r->v], bu = r->at[b][r->u], bv = r->at[b][r->v];
    // From its lower end, whichever way the triangle goes: both of its triangles find the same numbers, and a sample on it is the one's
    // that lies where they are positive.
    edge->isFar = !(fmax(fmax(fabs(au), fabs(av)), fmax(fabs(bu), fabs(bv))) < LPV_EXACT);
    const int isBelow = edge->isFar ? bu < au : whole[b][r->u] < whole[a][r->u], isBeside = edge->isFar ? bu == au : whole[b][r->u] == whole[a][r->u];
    const int isTurned = isBelow || (isBeside && (edge->isFar ? bv < av : whole[b][r->v] < whole[a][r->v]));
    edge->isAbove = isTurned ? turn < 0 : turn > 0;
    edge->from[0] = isTurned ? bu : au;
    edge->from[1] = isTurned ? bv : av;
    edge->to[0] = isTurned ? au : bu;
    edge->to[1] = isTurned ? av : bv;
    edge->at = edge->stepU = edge->stepV = 0;
    if (edge->isFar) return;
    const int p = isTurned ? b : a, q = isTurned ? a : b;
    const long pu = whole[p][r->u], pv = whole[p][r->v], du = whole[q][r->u] - pu, dv = whole[q][r->v] - pv;
    const long at = du * (LPV_STEPS / 2 - pv) - dv * (LPV_STEPS / 2 - pu), sign = edge->isAbove ? 1 : -1;
    edge->at = sign * at - (edge->isAbove ? 0 : 1);
    edge->stepU = -sign * dv * LPV_STEPS;
    edge->stepV = sign * du * LPV_STEPS;
}

// Which way round the triangle goes in (u, v): 1, -1, or 0 where it has no area there.
LW_FN int raster_turn(const lpv_raster* r, int (*whole)[3], int isFar, float along) {
    if (isFar) return along > 0.0f ? 1 : along < 0.0f ? -1 : 0;
    const long du = whole[1][r->u] - (long)whole[0][r->u], dv = whole[1][r->v] - (long)whole[0][r->v],
               eu = whole[2][r->u] - (long)whole[0][r->u], ev = whole[2][r->v] - (long)whole[0][r->v];
    const long area = du * ev - dv * eu;
    return area > 0 ? 1 : area < 0 ? -1 : 0;
}

// A triangle, without samples yet; 0: it has none anywhere. (By pointer: what a loop's functions return Oclgrind does not know.)
LW_FN int raster_of(__global const float* triangles, int stride, int t, const lpv_lattice* lattice, float scale, lpv_raster* r) {
    float along[2][3];  // two sides of the triangle, of vertices as they are: far from the origin samples would be coarse
    int whole[3][3];
    r->isFar = 0;
    for (int a = 0; a < 3; ++a) {
        const float p[3] = {triangles[(LW_TRIANGLE_A + a) * stride + t], triangles[(LW_TRIANGLE_B + a) * stride + t],
                            triangles[(LW_TRIANGLE_C + a) * stride + t]};
        for (int k = 0; k < 3; ++k) {
            const float at = (p[k] - lattice->from[a]) * scale;
            r->at[k][a] = at;
            const int isExact = fabs(at) < LPV_EXACT;
            whole[k][a] = isExact ? whole_below(at * (float)LPV_STEPS + 0.5f) : 0;
            r->isFar = r->isFar || !isExact;
        }
        along[0][a] = (p[1] - p[0]) * scale;
        along[1][a] = (p[2] - p[0]) * scale;
    }
    float n[3] = {along[0][1] * along[1][2] - along[0][2] * along[1][1], along[0][2] * along[1][0] - along[0][0] * along[1][2],
                  along[0][0] * along[1][1] - along[0][1] * along[1][0]};
    const float largest = fmax(fmax(fabs(n[0]), fabs(n[1])), fabs(n[2]));
    if (!(largest > 0.0f && largest < FLT_MAX)) return 0;
    for (int a = 0; a < 3; ++a) n[a] /= largest;
    const float length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    r->nx = n[0] / length;
    r->ny = n[1] / length;
    r->nz = n[2] / length;
    r->axis = fabs(n[0]) == 1.0f ? 0 : fabs(n[1]) == 1.0f ? 1 : 2;
    r->u = r->axis == 0 ? 1 : 0;
    r->v = r->axis == 2 ? 1 : 2;
    r->slopeU = -n[r->u] / n[r->axis];
    r->slopeV = -n[r->v] / n[r->axis];
    r->area = length / (float)(LPV_RASTER * LPV_RASTER);
    // Along y, (u, v) is (x, z), which is left-handed about it.
    const int turn = raster_turn(r, whole, r->isFar, r->axis == 1 ? -n[1] : n[r->axis]);
    for (int k = 0; k < 3; ++k) raster_edge(r, whole, k, k == 2 ? 0 : k + 1, turn, &r->edges[k]);
    return turn != 0;
}

LW_FN void raster_range(const lpv_raster* r, int axis, int from, int to, int* first, int* last) {
    const float least = fmin(fmin(r->at[0][axis], r->at[1][axis]), r->at[2][axis]), most = fmax(fmax(r->at[0][axis], r->at[1][axis]), r->at[2][axis]);
    // One too many does no harm.
    *first = whole_below(clamp(least - 1.0f, (float)from, (float)to));
    *last = min(whole_below(clamp(most, (float)from, (float)to)), to - 1);
}

// Which of its samples may count in a part of a grid.
LW_FN void raster_within(lpv_raster* r, const lpv_lattice* lattice, lw_int4 low, lw_int4 high) {
    raster_range(r, r->u, samples_from(lattice, low, r->u), samples_to(lattice, high, r->u), &r->firstU, &r->lastU);
    raster_range(r, r->v, samples_from(lattice, low, r->v), samples_to(lattice, high, r->v), &r->firstV, &r->lastV);
}

LW_FN int raster_far(const lpv_edge* edge, int u, int v) {
    if (!edge->isFar) return edge->at + edge->stepU * u + edge->stepV * v >= 0;
    const float x = (float)u + 0.5f, y = (float)v + 0.5f;
    const float e = (edge->to[0] - edge->from[0]) * (y - edge->from[1]) - (edge->to[1] - edge->from[1]) * (x - edge->from[0]);
    return edge->isAbove ? e >= 0.0f : e < 0.0f;
}

// The edges' numbers for raster_sample(), which takes a row's samples one after the other.
LW_FN void raster_row(const lpv_raster* r, int v, long* edges) {
    for (int k = 0; k < 3; ++k) edges[k] = r->edges[k].at + r->edges[k].stepU * r->firstU + r->edges[k].stepV * v;
}

// Whether a sample lies in the triangle.
LW_FN int raster_sample(const lpv_raster* r, int u, int v, long* edges) {
    const int isInside = (edges[0] | edges[1] | edges[2]) >= 0;
    for (int k = 0; k < 3; ++k) edges[k] += r->edges[k].stepU;
    return r->isFar ? raster_far(&r->edges[0], u, v) && raster_far(&r->edges[1], u, v) && raster_far(&r->edges[2], u, v) : isInside;
}

// Where a sample in the triangle lies, in cells of the lattice.
LW_FN void raster_place(const lpv_raster* r, int u, int v, float* cells) {
    const float x = (float)u + 0.5f, y = (float)v + 0.5f, unit = 1.0f / (float)LPV_RASTER;
    cells[r->u] = x * unit;
    cells[r->v] = y * unit;
    cells[r->axis] = (r->at[0][r->axis] + (x - r->at[0][r->u]) * r->slopeU + (y - r->at[0][r->v]) * r->slopeV) * unit;
}

#endif
