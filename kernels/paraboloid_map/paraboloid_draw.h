// Triangles into a map's records, in two sweeps that do the same but for what they do with a hit: the first leaves
// the least distance in each texel, the second the least triangle among those at that distance. Both are integer
// minima, so the records do not depend on who comes first.
//
// The first sweep notes which triangles reached a texel at all when they came (not later than now nearest).
// Which they are depends on the order, but those that stay nearest are always among them: the second
// sweep looks at no others.
#ifndef LW_PARABOLOID_DRAW_H
#define LW_PARABOLOID_DRAW_H

#include "paraboloid_raster.h"
#include "shared/paraboloid_map_types.h"

#define LW_DEPTH 0
#define LW_IDENTITY 1

// Texels of a triangle's box up to which 16 triangles are drawn at once, a texel of each; above it, a triangle's
// texels 16 at once. And those of a large triangle, which are shared among work-items: too few, and the list
// costs more than they do; too many, and one work-item keeps all others waiting.
#define LW_FEW_TEXELS 16
#define LW_MANY_TEXELS (64 * LW_WIDTH)

typedef struct {
    lw_paraboloid frame;
    volatile __global uint* records;
    int size, first;  // first: record of the map
    float step;
} lw_canvas;

LW_FN lw_canvas canvas_of(__global const lw_paraboloid* frames, volatile __global uint* records, int size, int map) {
    lw_canvas c;
    c.frame = frames[map];
    c.records = records;
    c.size = size;
    c.first = map * size * size;
    c.step = paraboloid_step(size);
    return c;
}

// One hit. Distances are positive, so their bits are ordered as they are. 1: it may be the nearest.
// The distance is tested before the atomic, which costs ten times as much and mostly changes nothing; a
// value read too early is only too large.
LW_FN int touch(volatile __global uint* record, float distance, uint triangle, const int sweep) {
    const uint bits = as_uint(distance), nearest = record[0];
    if (sweep == LW_DEPTH) {
        if (bits < nearest) atomic_min(record, bits);
        return bits <= nearest;
    }
    if (bits == nearest) atomic_min(record + 1, triangle);
    return 0;
}

// Lanes that hit (distance above 0) texels `at` of the map; `triangle`: of lane 0, `perLane` more in each next.
// Bit l of the result: touch() of lane l.
LW_FN uint touch_lanes(lw_canvas c, real distance, lanei at, uint triangle, uint perLane, const int sweep) {
    float distances[LW_WIDTH];
    int texels[LW_WIDTH];
    store(distance, distances, 0);
    store(at, texels, 0);
    uint reached = 0;
    for (int l = 0; l < LW_WIDTH; ++l)
        if (distances[l] > 0.0f)
            reached |= (uint)touch(c.records + 2 * (c.first + texels[l]), distances[l], triangle + (uint)l * perLane,
                                   sweep) << l;
    return reached;
}

// Triangles `triangle`, `triangle + 1`, ... of few texels: in every step one texel of each.
LW_FN uint draw_few(lw_canvas c, lw_planes planes, lw_texel_box box, mask live, uint triangle, const int sweep) {
    uint reached = 0;
    lanei x = box.x0, y = box.y0;
    do {
        const real distance = select_((real)(0.0f), hit_distance(c.frame, c.step, planes, x, y), live);
        if (any_(distance > 0.0f)) reached |= touch_lanes(c, distance, y * c.size + x, triangle, 1, sweep);
        x = x + 1;
        const mask next = x > box.x1;
        x = selecti_(x, box.x0, next);
        y = selecti_(y, y + 1, next);
        live = and_(live, y <= box.y1);
    } while (any_(live));
    return reached;
}

// One triangle, the same in every lane: row by row, LW_WIDTH texels at a time. 1: a texel was reached.
LW_FN uint draw_rows(lw_canvas c, lw_planes planes, int x0, int x1, int y0, int y1, uint triangle, const int sweep) {
    uint reached = 0;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; x += LW_WIDTH) {
            // A row's last texels instead of the next row's first: drawn twice, they stay the same.
            const int start = min(x, c.size - LW_WIDTH);
            const lanei column = lanei_iota() + start;
            const real distance = hit_distance(c.frame, c.step, planes, column, (lanei)(y));
            if (any_(distance > 0.0f)) reached |= touch_lanes(c, distance, column + y * c.size, triangle, 0, sweep);
        }
    return reached != 0;
}

// One triangle, the same in every lane, in a row of tiles: LW_WIDTH tiles are looked at together, and those that
// it can cover are drawn. 1: a texel was reached.
LW_FN uint draw_tiles(lw_canvas c, lw_planes planes, int tileX0, int tileX1, int tileY, uint triangle, const int sweep) {
    uint reached = 0;
    for (int first = tileX0; first <= tileX1; first += LW_WIDTH) {
        int touched[LW_WIDTH];
        store(tiles_touched(c.frame, c.step, planes, lanei_iota() + first, tileY), touched, 0);
        for (int l = 0; l < min(LW_WIDTH, tileX1 - first + 1); ++l) {
            if (!touched[l]) continue;
            const int x = (first + l) * LW_TILE, y = tileY * LW_TILE;
            reached |= draw_rows(c, planes, x, x + LW_TILE - 1, y, y + LW_TILE - 1, triangle, sweep);
        }
    }
    return reached;
}

// Where large triangles go, and the counters of the list; room for `capacity`.
typedef struct {
    __global lw_large_triangle* list;
    volatile __global uint* counters;
    int capacity;
} lw_large_list;

// 1: the list has it.
LW_FN int put_large(lw_large_list large, int map, int triangle, int x0, int x1, int y0, int y1) {
    const uint slot = atomic_inc(large.counters + LW_MAP_LARGE);
    if (slot >= (uint)large.capacity) {
        atomic_inc(large.counters + LW_MAP_INLINE);
        return 0;
    }
    lw_large_triangle entry;
    entry.map = map;
    entry.triangle = triangle;
    entry.columns = (x0 / LW_TILE) | ((x1 / LW_TILE) << 16);
    entry.rows = (y0 / LW_TILE) | ((y1 / LW_TILE) << 16);
    entry.reached = 0;
    large.list[slot] = entry;
    return 1;
}

// The triangles of a batch that need rows: lane by lane.
LW_FN uint draw_many(lw_canvas c, __global const float* triangles, int stride, lw_texel_box box, mask many, int map,
                     int triangle, lw_large_list large, const int sweep) {
    int wanted[LW_WIDTH], x0[LW_WIDTH], x1[LW_WIDTH], y0[LW_WIDTH], y1[LW_WIDTH];
    store(many, wanted, 0);
    store(box.x0, x0, 0);
    store(box.x1, x1, 0);
    store(box.y0, y0, 0);
    store(box.y1, y1, 0);
    uint reached = 0;
    for (int l = 0; l < LW_WIDTH; ++l) {
        if (!wanted[l]) continue;
        const int texels = (x1[l] - x0[l] + 1) * (y1[l] - y0[l] + 1);
        if (sweep == LW_DEPTH && texels > LW_MANY_TEXELS &&
            put_large(large, map, triangle + l, x0[l], x1[l], y0[l], y1[l]))
            continue;
        const lw_planes planes = planes_of(splat_corners(triangles, stride, triangle + l, c.frame.origin));
        reached |= draw_rows(c, planes, x0[l], x1[l], y0[l], y1[l], (uint)(triangle + l), sweep) << l;
    }
    return reached;
}

// A group's triangles, those of `which` (a bit each). The result: those that reached a texel and are not in the list
// of large ones.
LW_FN uint draw_group(lw_canvas c, __global const float* triangles, int stride, int group, uint which, int map,
                      lw_large_list large, const int sweep) {
    uint reached = 0;
    for (int i = 0; i < LW_TRIANGLE_GROUP; i += LW_WIDTH) {
        const int triangle = group * LW_TRIANGLE_GROUP + i;
        const lw_corners corners = load_corners(triangles, stride, triangle, c.frame.origin);
        const lw_texel_box box = box_of_corners(c.frame, c.size, corners);
        const mask drawn = and_(box.any, to_mask(((lanei)((int)which) >> (lanei_iota() + i)) & 1));
        if (!any_(drawn)) continue;
        const lanei texels = (box.x1 - box.x0 + 1) * (box.y1 - box.y0 + 1);
        const mask few = and_(drawn, texels <= LW_FEW_TEXELS), many = and_(drawn, texels > LW_FEW_TEXELS);
        if (any_(few)) reached |= draw_few(c, planes_of(corners), box, few, (uint)triangle, sweep) << i;
        if (any_(many)) reached |= draw_many(c, triangles, stride, box, many, map, triangle, large, sweep) << i;
    }
    return reached;
}

#endif
