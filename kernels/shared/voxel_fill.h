// How the bricks of a voxel grid are shared out among work-items, and what each does with a facet.
#ifndef LW_VOXEL_FILL_H
#define LW_VOXEL_FILL_H

#include "lpv_types.h"
#include "voxel_clip.h"
#include "voxel_grid_types.h"
#include "voxel_surface.h"

// Parts of a brick, of whole layers, that are a task each: 1, 2, 4, 8.
#ifndef FILL_TASKS
#define FILL_TASKS 1
#endif
#define FILL_LAYERS (LW_VOXEL_BRICK / FILL_TASKS)
#define FILL_WORDS (LW_VOXEL_WORDS / FILL_TASKS)
#define FILL_VOXELS (LW_VOXEL_BRICK_VOXELS / FILL_TASKS)

typedef struct {
    int brick, part, corner[3], first, last;  // corner: the brick's first voxel; layers first .. last of it
    float4 centre, half_;                     // in the world, a little larger than they are
} lw_task;

LW_FN void task_of(int brick, int part, int size, __global const LwLpvPlace* place, lw_task* task) {
    const int side = size / LW_VOXEL_BRICK;
    const float cell = place->cell.x;
    task->brick = brick;
    task->part = part;
    task->corner[0] = brick % side * LW_VOXEL_BRICK;
    task->corner[1] = brick / side % side * LW_VOXEL_BRICK;
    task->corner[2] = brick / (side * side) * LW_VOXEL_BRICK;
    task->first = part * FILL_LAYERS;
    task->last = task->first + FILL_LAYERS - 1;
    const float4 middle = (float4)((float)task->corner[0] + 0.5f * LW_VOXEL_BRICK, (float)task->corner[1] + 0.5f * LW_VOXEL_BRICK,
                                   (float)(task->corner[2] + task->first) + 0.5f * FILL_LAYERS, 0.0f);
    task->centre = (float4)(place->origin.xyz, 0.0f) + middle * cell;
    // What touches a side from without counts; the rest is rounding, of places far from the world's origin too.
    task->half_ = (float4)(0.5f * LW_VOXEL_BRICK, 0.5f * LW_VOXEL_BRICK, 0.5f * FILL_LAYERS, 0.0f) * cell + 0.01f * cell +
                  1e-6f * (fabs(task->centre) + fabs((float4)(place->origin.xyz, 0.0f)));
}

// Where a voxel lies among those of a task, or -1.
LW_FN int place_in(const lw_task* task, const int* voxel) {
    const int x = voxel[0] - task->corner[0], y = voxel[1] - task->corner[1], z = voxel[2] - task->corner[2];
    if (x < 0 || x >= LW_VOXEL_BRICK || y < 0 || y >= LW_VOXEL_BRICK || z < task->first || z > task->last) return -1;
    return x + LW_VOXEL_BRICK * (y + LW_VOXEL_BRICK * (z - task->first));
}

// The axis along which its voxels are several, where that is one.
LW_FN int axis_of_spans(const int* from, const int* to) { return from[0] != to[0] ? 0 : from[1] != to[1] ? 1 : 2; }

// Of a facet in a row of voxels: cuts across the row only.
LW_FN void fill_row(const lw_facet* f, const lw_coat* coat, const lw_task* task, int* voxel, const int* to, long* sums) {
    const int axis = axis_of_spans(voxel, to), w = dominant_axis(f->n), last = min(to[axis], task->corner[axis] + LW_VOXEL_BRICK - 1);
    if (!(f->area > 0.0f)) return;
    const float unit = 0.5f / fabs(f->n[w]);
    lw_polygon g, part;
    polygon_of(f, &g);
    if (voxel[axis] < task->corner[axis]) {
        voxel[axis] = task->corner[axis];
        take_below(&g, axis, (float)voxel[axis] - f->base[axis], &part);
    }
    for (; voxel[axis] <= last && g.count; ++voxel[axis]) {
        if (voxel[axis] < to[axis]) {
            take_below(&g, axis, (float)(voxel[axis] + 1) - f->base[axis], &part);
        } else {
            copy_polygon(&g, &part);
        }
        const int at = place_in(task, voxel);
        if (at >= 0 && part.count) add_area(polygon_area(&part, w == 0 ? 1 : 0, w == 2 ? 1 : 2) * unit, coat, sums + SURFACE_SUMS * at);
    }
}

// Most triangles lie in a voxel each, or in a row of voxels, all of which they touch: they reach from the first one to the last.
LW_FN void occupy_task(lw_facet* f, const lw_task* task, uint* words) {
    int voxel[3], to[3];
    if (facet_spans(f, voxel, to) <= 1) {
        const int axis = axis_of_spans(voxel, to), last = min(to[axis], task->corner[axis] + LW_VOXEL_BRICK - 1);
        for (voxel[axis] = max(voxel[axis], task->corner[axis]); voxel[axis] <= last; ++voxel[axis]) {
            const int at = place_in(task, voxel);
            if (at >= 0) words[at >> 5] |= 1u << (at & 31);
        }
        return;
    }
    if (f->count == 3) orient_facet(f);
    touch_voxels(f, task->corner, task->first, task->last, words);
}

LW_FN void fill_task(const lw_facet* f, const lw_coat* coat, const lw_task* task, long* sums) {
    int voxel[3], to[3];
    const int spans = facet_spans(f, voxel, to);
    if (spans > 1) {
        fill_voxels(f, coat, task->corner, task->first, task->last, sums);
    } else if (spans == 1) {
        fill_row(f, coat, task, voxel, to, sums);
    } else {
        const int at = place_in(task, voxel);
        if (at >= 0) add_area(f->area, coat, sums + SURFACE_SUMS * at);
    }
}

// The sums of a task's voxels as what surfaces() holds.
LW_FN void store_sums(const long* sums, const lw_task* task, int slot, int slots, __global uint* surfaces) {
    const int plane = slots * LW_VOXEL_BRICK_VOXELS;
    __global uint* to = surfaces + slot * LW_VOXEL_BRICK_VOXELS + task->part * FILL_VOXELS;
    const float unit = 1.0f / SURFACE_WHOLE;
    const uint empty = pack_surface_normal(0.0f, 0.0f, 0.0f);
    for (int i = 0; i < FILL_VOXELS; ++i) {
        const long* sum = sums + SURFACE_SUMS * i;
        if (sum[3] == 0) {  // most are empty
            for (int k = 0; k < LW_SURFACE_PLANES; ++k) to[k * plane + i] = k == LW_SURFACE_NORMAL ? empty : 0u;
            continue;
        }
        float s[SURFACE_SUMS];
        for (int k = 0; k < SURFACE_SUMS; ++k) s[k] = (float)sum[k] * unit;
        const float inverse = 1.0f / s[3];
        for (int k = 0; k < 4; ++k) to[(LW_SURFACE_AREA_X + k) * plane + i] = as_uint(s[k]);
        to[LW_SURFACE_NORMAL * plane + i] = pack_surface_normal(s[4] * inverse, s[5] * inverse, s[6] * inverse);
        to[LW_SURFACE_ALBEDO * plane + i] = pack_surface_albedo(s[7] * inverse, s[8] * inverse, s[9] * inverse);
        to[LW_SURFACE_EMISSION * plane + i] = pack_surface_emission(s[10] * inverse, s[11] * inverse, s[12] * inverse);
    }
}

#endif
