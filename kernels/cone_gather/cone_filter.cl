// Second half of the interleaved cones: each pixel takes the sums over a window of LW_CONE_COLUMNS x LW_CONE_ROWS pixels, which holds
// each cone exactly once, of the neighbours on its own surface, over the sum of their cones' weights: what an edge leaves out changes
// which directions count, not how much light there is. At the image's border the window is moved inside, so that it stays complete.
#ifndef LW_CONE_COLUMNS
#define LW_CONE_COLUMNS 3
#endif
#ifndef LW_CONE_ROWS
#define LW_CONE_ROWS 3
#endif
#ifndef LW_CONE_OPEN
#define LW_CONE_OPEN 0
#endif
#include "shared/edge_weight.h"
#include "shared/filter_rows.h"
#include "shared/wide.h"

#define LW_GATHERED (LW_CONE_OPEN ? 6 : 5)
// Pixels of the window to the left of and above its middle.
#define LW_LEFT ((LW_CONE_COLUMNS - 1) / 2)
#define LW_ABOVE ((LW_CONE_ROWS - 1) / 2)

typedef struct { real v[6]; } cone_window;

// Where a window's row begins in each image, and the distances between planes.
typedef struct { int position, normal, gathered, positionPlane, normalPlane, gatheredPlane; } cone_row;

// One row of images for those of a work-item's rows whose windows hold it (`which`, a bit each). `inside`, a constant: all lanes have the
// same shift; otherwise `first` holds each lane's first column.
LW_FN void add_row(cone_window* sums, const lw_edges* edges, const int which, __global const float* position, __global const float* normal,
                   __global const float* gathered, const cone_row* row, const int inside, lanei first, int columns) {
#define LW_TAP(image, at) (inside ? load(image, (at) + i) : gather(image, first + (lanei)((at) + i)))
    for (int i = 0; i < columns; ++i) {
        const real px = LW_TAP(position, row->position), py = LW_TAP(position, row->position + row->positionPlane),
                   pz = LW_TAP(position, row->position + 2 * row->positionPlane);
        const real nx = LW_TAP(normal, row->normal), ny = LW_TAP(normal, row->normal + row->normalPlane),
                   nz = LW_TAP(normal, row->normal + 2 * row->normalPlane);
        real w[LW_FILTER_ROWS];
        LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k)
            if (which >> k & 1) w[k] = edge_weight(edges[k], px, py, pz, nx, ny, nz);
        LW_UNROLL for (int a = 0; a < LW_GATHERED; ++a) {
            const real value = LW_TAP(gathered, row->gathered + a * row->gatheredPlane);
            LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k)
                if (which >> k & 1) sums[k].v[a] = fma_(w[k], value, sums[k].v[a]);
        }
    }
#undef LW_TAP
}

// One work-item = LW_WIDTH adjacent pixels of LW_FILTER_ROWS rows. gathered: as cone_gather_trace leaves them. irradiance: 3 planes,
// W/m^2; validity, open: 1 plane each.
__kernel void cone_gather_filter(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                                 int width, int height, __global const float* gathered, int4 gatheredLayout, int hasIrradiance,
                                 int hasValidity, int hasOpen, __global float* irradiance, int4 irradianceLayout,
                                 __global float* validity, int4 validityLayout, __global float* open, int4 openLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1) * LW_FILTER_ROWS;
    if (x >= width || y >= height) return;
    const int start = x - LW_LEFT, columns = min(LW_CONE_COLUMNS, width), rows = min(LW_CONE_ROWS, height);
    const int lastRow = max(height - LW_CONE_ROWS, 0), inside = start >= 0 && start + LW_CONE_COLUMNS - 1 + LW_WIDTH <= width;
    const lanei first = clamp(lanei_iota() + (lanei)start, (lanei)0, (lanei)max(width - LW_CONE_COLUMNS, 0));
    const real none = (real)0.0f, one = (real)1.0f;
    lw_edges edges[LW_FILTER_ROWS];
    mask valid[LW_FILTER_ROWS], some = splat_mask(0);
    cone_window sums[LW_FILTER_ROWS];
    LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k) {
        const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, min(y + k, height - 1));
        edges[k] = edges_of(s, s.scale);
        valid[k] = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
        some = or_(some, valid[k]);
        LW_UNROLL for (int a = 0; a < 6; ++a) sums[k].v[a] = none;
    }
    const int from = clamp(y - LW_ABOVE, 0, lastRow), second = clamp(y + LW_FILTER_ROWS - 1 - LW_ABOVE, 0, lastRow);
    for (int j = from; any_(some) && j < second + rows; ++j) {
        const int shift = inside ? start : 0;
        const cone_row row = {positionLayout.x + j * positionLayout.y + shift, normalLayout.x + j * normalLayout.y + shift,
                              gatheredLayout.x + j * gatheredLayout.y + shift, positionLayout.z, normalLayout.z, gatheredLayout.z};
        const int which = (j < from + rows ? 1 : 0) | (j >= second ? 2 : 0);
        if (!inside) add_row(sums, edges, which, position, normal, gathered, &row, 0, first, columns);
        else if (which == 3) add_row(sums, edges, 3, position, normal, gathered, &row, 1, first, LW_CONE_COLUMNS);
        else if (which == 1) add_row(sums, edges, 1, position, normal, gathered, &row, 1, first, LW_CONE_COLUMNS);
        else add_row(sums, edges, 2, position, normal, gathered, &row, 1, first, LW_CONE_COLUMNS);
    }
    LW_UNROLL for (int k = 0; k < LW_FILTER_ROWS; ++k) {
        if (y + k >= height) continue;
        const mask lit = and_(valid[k], sums[k].v[4] > none);
        const real scale = select_(none, 1.0f / sums[k].v[4], lit);
        if (hasIrradiance)
            for (int a = 0; a < 3; ++a)
                store(select_(none, M_PI_F * scale * sums[k].v[a], lit), irradiance,
                      irradianceLayout.x + a * irradianceLayout.z + (y + k) * irradianceLayout.y + x);
        if (hasValidity)
            store(select_(none, fmin(scale * sums[k].v[3], one), lit), validity, validityLayout.x + (y + k) * validityLayout.y + x);
        if (hasOpen) store(select_(none, fmin(scale * sums[k].v[5], one), lit), open, openLayout.x + (y + k) * openLayout.y + x);
    }
}
