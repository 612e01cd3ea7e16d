// A triangle as samples on a grid's own lattice, LPV_RASTER to a cell's side each way, seen along the triangle's dominant axis. A surface
// that spans a cell has all of the cell's samples, whatever its triangles, and no chance: each sample on an edge belongs to one of the
// two triangles there. Surfels drawn by area would have to be as dense in all of the scene as the finest grid wants them.
#ifndef LW_LPV_RASTER_H
#define LW_LPV_RASTER_H

#include "geometry_types.h"
#include "lpv_types.h"
#include "wide.h"  // no contraction: both triangles of an edge must find the same number

// Less: surfaces that end within a cell count by quarters of it or more. More: time, with the square.
#define LPV_RASTER 4

typedef struct {
    float at[3][3];         // vertices, in samples from the grid's corner
    float nx, ny, nz;       // unit normal
    float area;             // of one sample, in sides of a cell
    float slopeU, slopeV;   // of the height along the axis
    float turn;             // 1: vertices run counter-clockwise in (u, v), -1: clockwise
    int axis, u, v;         // the dominant axis, and the other two
    int firstU, lastU, firstV, lastV;  // samples that may lie in it; last below first: none does
} lpv_raster;

LW_FN float raster_corner(__global const float* triangles, int stride, int plane, int t, float origin, float scale) {
    return (triangles[plane * stride + t] - origin) * scale;
}

// (Not as a result: of a loop's, compilers say what Oclgrind does not know.)
LW_FN void raster_of(__global const float* triangles, int stride, int t, const LwLpvPlace place, int size, lpv_raster* r) {
    const float origin[3] = {place.origin.x, place.origin.y, place.origin.z}, scale = (float)LPV_RASTER * place.origin.w;
    const float most = (float)(LPV_RASTER * size);
    r->firstU = r->firstV = 0;
    r->lastU = r->lastV = -1;
    int isNear = 1, spans = 0;
    for (int a = 0; a < 3; ++a) {
        const float p = raster_corner(triangles, stride, LW_TRIANGLE_A + a, t, origin[a], scale),
                    q = raster_corner(triangles, stride, LW_TRIANGLE_B + a, t, origin[a], scale),
                    s = raster_corner(triangles, stride, LW_TRIANGLE_C + a, t, origin[a], scale);
        r->at[0][a] = p;
        r->at[1][a] = q;
        r->at[2][a] = s;
        const float low = fmin(fmin(p, q), s), high = fmax(fmax(p, q), s);
        // What lies half a cell off is of use.
        isNear = isNear && high > -(float)LPV_RASTER && low < most + (float)LPV_RASTER;
        // The last sample below the upper end, if it lies above the lower one. (Rounding up or down takes PoCL long.)
        const float upper = high - 0.5f;
        spans += upper >= 0.0f && (float)(int)fmin(upper, most - 1.0f) + 0.5f >= low;
    }
    // Without samples along two axes there are none seen along any: most triangles are that small.
    if (!isNear || spans < 2 || !(place.origin.w > 0.0f)) return;
    const float ux = r->at[1][0] - r->at[0][0], uy = r->at[1][1] - r->at[0][1], uz = r->at[1][2] - r->at[0][2];
    const float vx = r->at[2][0] - r->at[0][0], vy = r->at[2][1] - r->at[0][1], vz = r->at[2][2] - r->at[0][2];
    float n[3] = {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
    const float largest = fmax(fmax(fabs(n[0]), fabs(n[1])), fabs(n[2]));
    if (!(largest > 0.0f && largest < FLT_MAX)) return;
    for (int a = 0; a < 3; ++a) n[a] /= largest;
    const float length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    r->nx = n[0] / length;
    r->ny = n[1] / length;
    r->nz = n[2] / length;
    r->axis = fabs(n[0]) == 1.0f ? 0 : fabs(n[1]) == 1.0f ? 1 : 2;
    r->u = r->axis == 0 ? 1 : 0;
    r->v = r->axis == 2 ? 1 : 2;
    // Along y, (u, v) is (x, z), which is left-handed about it.
    r->turn = (n[r->axis] > 0.0f) == (r->axis != 1) ? 1.0f : -1.0f;
    r->slopeU = -n[r->u] / n[r->axis];
    r->slopeV = -n[r->v] / n[r->axis];
    r->area = length / (float)(LPV_RASTER * LPV_RASTER);
    const float lowU = fmin(fmin(r->at[0][r->u], r->at[1][r->u]), r->at[2][r->u]), highU = fmax(fmax(r->at[0][r->u], r->at[1][r->u]), r->at[2][r->u]);
    const float lowV = fmin(fmin(r->at[0][r->v], r->at[1][r->v]), r->at[2][r->v]), highV = fmax(fmax(r->at[0][r->v], r->at[1][r->v]), r->at[2][r->v]);
    // One too many does no harm.
    r->firstU = (int)clamp(lowU - 0.5f, 0.0f, most);
    r->lastU = (int)clamp(highU - 0.5f, 0.0f, most - 1.0f);
    r->firstV = (int)clamp(lowV - 0.5f, 0.0f, most);
    r->lastV = (int)clamp(highV - 0.5f, 0.0f, most - 1.0f);
}

// Is (x, y) on this triangle's side of the edge between two of its vertices? The edge is taken from its lower end, whichever way the
// triangle goes, so that both of its triangles find the same number, and a sample on it is the one's that lies where it is positive.
LW_FN int raster_inside(const lpv_raster* r, int from, int to, float x, float y) {
    const float au = r->at[from][r->u], av = r->at[from][r->v], bu = r->at[to][r->u], bv = r->at[to][r->v];
    const int isTurned = bu < au || (bu == au && bv < av);
    const float pu = isTurned ? bu : au, pv = isTurned ? bv : av, qu = isTurned ? au : bu, qv = isTurned ? av : bv;
    const float e = (qu - pu) * (y - pv) - (qv - pv) * (x - pu);
    return (isTurned ? -r->turn : r->turn) > 0.0f ? e >= 0.0f : e < 0.0f;
}

// Whether a sample lies in the triangle; if so where, in cells from the grid's corner.
LW_FN int raster_sample(const lpv_raster* r, int u, int v, float* cells) {
    const float x = (float)u + 0.5f, y = (float)v + 0.5f, unit = 1.0f / (float)LPV_RASTER;
    if (!(raster_inside(r, 0, 1, x, y) && raster_inside(r, 1, 2, x, y) && raster_inside(r, 2, 0, x, y))) return 0;
    cells[r->u] = x * unit;
    cells[r->v] = y * unit;
    cells[r->axis] = (r->at[0][r->axis] + (x - r->at[0][r->u]) * r->slopeU + (y - r->at[0][r->v]) * r->slopeV) * unit;
    return 1;
}

#endif
