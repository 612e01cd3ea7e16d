// The voxels of a grid that triangles touch, and the area of these in each. Every brick gathers its own: sums stay with the
// work-item that makes them, bricks that do not change are left alone, and a triangle of any size is many bricks' work.
#include "shared/geometry_types.h"
#include "shared/lpv_types.h"
#include "shared/voxel_clip.h"
#include "shared/voxel_fill.h"

#define TREE_STACK (LW_TREE_LEVELS * LW_TREE_CHILDREN)

// What of the tree of boxes may still touch a box.
typedef struct {
    float4 centre, half_;
    int top, child[TREE_STACK];  // node * LW_TREE_CHILDREN + child
} lw_walk;

LW_FN void open_node(lw_walk* walk, __global const float* nodes, int number) {
    __global const float* node = nodes + LW_TREE_NODE * number;
    for (int i = 0; i < LW_TREE_CHILDREN; i += LW_WIDTH) {
        const real hx = load(node, LW_TREE_HALF + i), hy = load(node, LW_TREE_HALF + 16 + i), hz = load(node, LW_TREE_HALF + 32 + i);
        const mask near = and_(and_(fabs(load(node, i) - walk->centre.x) <= hx + walk->half_.x,
                                    fabs(load(node, 16 + i) - walk->centre.y) <= hy + walk->half_.y),
                               and_(fabs(load(node, 32 + i) - walk->centre.z) <= hz + walk->half_.z, hx >= 0.0f));
        uint bits = bits_(near);
        while (bits) walk->child[walk->top++] = number * LW_TREE_CHILDREN + i + take_lowest(&bits);
    }
}

LW_FN void begin_walk(lw_walk* walk, __global const float* nodes, const lw_task* task) {
    walk->centre = task->centre;
    walk->half_ = task->half_;
    walk->top = 0;
    open_node(walk, nodes, 0);
}

// The next leaf's triangles, `count` from `first` on; 0 when there is none left.
LW_FN int next_leaf(lw_walk* walk, __global const float* nodes, int* first) {
    while (walk->top > 0) {
        const int child = walk->child[--walk->top];
        __global const int* at =
            (__global const int*)nodes + LW_TREE_NODE * (child / LW_TREE_CHILDREN) + LW_TREE_CHILD + child % LW_TREE_CHILDREN;
        const int count = at[LW_TREE_COUNT - LW_TREE_CHILD];
        *first = at[0];
        if (count > 0) return count;
        open_node(walk, nodes, at[0]);
    }
    return 0;
}

LW_FN mask spans_box(__global const float* p, int stride, float centre, float half_) {
    const real a = load(p, 0), b = load(p, LW_TRIANGLE_B * stride), c = load(p, LW_TRIANGLE_C * stride);
    return and_(fmin(a, fmin(b, c)) <= centre + half_, fmax(a, fmax(b, c)) >= centre - half_);
}

#define IN_VOXELS (-1)  // not in one alone

// Of the triangles of a leaf, those whose bounds touch the box: a bit each; and `where`, among the task's voxels, those lie that are
// within one (most are).
LW_FN uint touching(const lw_walk* walk, const lw_task* task, const float4 origin, __global const float* triangles, int stride, int first, int count,
                    int* where) {
    const float centre[3] = {walk->centre.x, walk->centre.y, walk->centre.z}, half_[3] = {walk->half_.x, walk->half_.y, walk->half_.z},
                from[3] = {origin.x, origin.y, origin.z};
    const int begin[3] = {0, 0, task->first}, end[3] = {LW_VOXEL_BRICK, LW_VOXEL_BRICK, task->last + 1};
    uint bits = 0;
    for (int i = 0; i < count; i += LW_WIDTH) {
        mask touches = lanei_iota() + (lanei)(i) < (lanei)(count), single = touches, inside = touches;
        lanei at = (lanei)(0);
        LW_UNROLL
        for (int a = 0; a < 3; ++a) {
            __global const float* p = triangles + first + i + a * stride;
            const real u = load(p, 0), v = load(p, LW_TRIANGLE_B * stride), w = load(p, LW_TRIANGLE_C * stride);
            const real low = fmin(u, fmin(v, w)), high = fmax(u, fmax(v, w));
            touches = and_(touches, and_(low <= centre[a] + half_[a], high >= centre[a] - half_[a]));
            const real lower = (low - from[a]) * origin.w * (1.0f - FACET_PLACE_ERROR), upper = (high - from[a]) * origin.w * (1.0f + FACET_PLACE_ERROR);
            const lanei voxel = to_lanei(clamp(lower, (real)(0.0f), (real)(65536.0f)));
            single = and_(single, and_(and_(lower > 0.0f, upper < 65536.0f),
                                       and_(voxel == to_lanei(clamp(upper, (real)(0.0f), (real)(65536.0f))), to_real(voxel) != lower)));
            const lanei local_ = voxel - (lanei)(task->corner[a]);
            inside = and_(inside, and_(local_ >= (lanei)(begin[a]), local_ < (lanei)(end[a])));
            at += (local_ - (lanei)(begin[a])) * (lanei)(a == 0 ? 1 : a == 1 ? LW_VOXEL_BRICK : LW_VOXEL_BRICK * LW_VOXEL_BRICK);
        }
        store(selecti_((lanei)(IN_VOXELS), at, single), where, i);
        bits |= bits_(and_(touches, or_(not_(single), inside))) << i;
    }
    return bits;
}

// From the vertex on that lies opposite the longest edge: of a sliver the short edge, which its area hangs on, is then not the
// difference of two long ones.
LW_FN void facet_of(__global const float* triangles, int stride, int t, const float4 origin, lw_facet* f) {
    const float corner[3] = {origin.x, origin.y, origin.z};
    float p[3][3], opposite[3] = {0.0f, 0.0f, 0.0f};
    for (int a = 0; a < 3; ++a) {
        for (int k = 0; k < 3; ++k) p[k][a] = triangles[(LW_TRIANGLE_A + 3 * k + a) * stride + t];
        for (int k = 0; k < 3; ++k) {
            const float d = p[(k + 2) % 3][a] - p[(k + 1) % 3][a];
            opposite[k] += d * d;
        }
    }
    const int first = opposite[0] >= fmax(opposite[1], opposite[2]) ? 0 : opposite[1] >= opposite[2] ? 1 : 2;
    f->count = 3;
    for (int a = 0; a < 3; ++a) {
        f->base[a] = (p[first][a] - corner[a]) * origin.w;
        for (int k = 0; k < 3; ++k) f->at[k][a] = (p[(first + k) % 3][a] - p[first][a]) * origin.w;
    }
    bound_facet(f);
}

// One work-item = every get_global_size(0)-th of the listed bricks' tasks: their occupied bits.
__kernel void voxel_triangles_occupy(__global const float* triangles, int stride, int count, __global const float* nodes,
                                     __global const LwLpvPlace* place, int size, __global const int* list,
                                     __global uint* occupied, __global const LwVoxelGrid* state) {
    if (!state->stale) return;
    const float4 origin = place->origin;
    for (int i = (int)get_global_id(0); i < state->todo * FILL_TASKS; i += (int)get_global_size(0)) {
        lw_task task;
        task_of(list[i / FILL_TASKS], i % FILL_TASKS, size, place, &task);
        uint words[FILL_WORDS];
        for (int w = 0; w < FILL_WORDS; ++w) words[w] = 0;
        lw_walk walk;
        walk.top = 0;
        int first, leaf = 0;
        if (count > 0 && origin.w > 0.0f) begin_walk(&walk, nodes, &task);
        while ((leaf = next_leaf(&walk, nodes, &first)) > 0) {
            int where[LW_TRIANGLE_GROUP];
            uint bits = touching(&walk, &task, origin, triangles, stride, first, leaf, where);
            while (bits) {
                const int lane = take_lowest(&bits), at = where[lane];
                if (at >= 0) {
                    words[at >> 5] |= 1u << (at & 31);
                    continue;
                }
                lw_facet f;
                facet_of(triangles, stride, first + lane, origin, &f);
                occupy_task(&f, &task, words);
            }
        }
        for (int w = 0; w < FILL_WORDS; ++w) occupied[LW_VOXEL_WORDS * task.brick + FILL_WORDS * task.part + w] = words[w];
    }
}

// The same of their surfaces, for those that have a slot. emissionPlane: first of three, or -1.
__kernel void voxel_triangles_fill(__global const float* triangles, int stride, int count, int emissionPlane,
                                   __global const float* nodes, __global const LwLpvPlace* place, int size,
                                   __global const int* list, __global const int* bricks, int slots, __global uint* surfaces,
                                   __global const LwVoxelGrid* state) {
    if (!state->stale) return;
    const float4 origin = place->origin;
    const float perEmission = 1.0f / state->emission;
    for (int i = (int)get_global_id(0); i < state->todo * FILL_TASKS; i += (int)get_global_size(0)) {
        const int slot = bricks[list[i / FILL_TASKS]];
        if (slot < 0) continue;
        lw_task task;
        task_of(list[i / FILL_TASKS], i % FILL_TASKS, size, place, &task);
        long sums[FILL_VOXELS * SURFACE_SUMS];
        for (int k = 0; k < FILL_VOXELS * SURFACE_SUMS; ++k) sums[k] = 0;
        lw_walk walk;
        walk.top = 0;
        int first, leaf = 0;
        if (count > 0 && origin.w > 0.0f) begin_walk(&walk, nodes, &task);
        while ((leaf = next_leaf(&walk, nodes, &first)) > 0) {
            int where[LW_TRIANGLE_GROUP];
            uint bits = touching(&walk, &task, origin, triangles, stride, first, leaf, where);
            while (bits) {
                const int lane = take_lowest(&bits), t = first + lane;
                lw_facet f;
                lw_coat coat;
                facet_of(triangles, stride, t, origin, &f);
                orient_facet(&f);
                coat.emits = 0;
                for (int c = 0; c < 3; ++c) {
                    coat.n[c] = f.n[c];
                    coat.albedo[c] = triangles[(LW_TRIANGLE_ALBEDO + c) * stride + t];
                    coat.emission[c] = emissionPlane >= 0 ? triangles[(emissionPlane + c) * stride + t] * perEmission : 0.0f;
                    coat.emits |= coat.emission[c] > 0.0f;
                }
                if (where[lane] >= 0) add_area(f.area, &coat, sums + SURFACE_SUMS * where[lane]);
                else fill_task(&f, &coat, &task, sums);
            }
        }
        store_sums(sums, &task, slot, slots, surfaces);
    }
}

// Triangles that a work-item counts.
#define OUTSIDE_RUN 64

// One work-item = OUTSIDE_RUN triangles: how many lie beyond the grid wholly.
__kernel void voxel_triangles_outside(__global const float* triangles, int stride, int count, __global const LwLpvPlace* place,
                                      int size, __global LwVoxelGrid* state) {
    const int first = (int)get_global_id(0) * OUTSIDE_RUN;
    if (first >= count || !state->stale || !(place->origin.w > 0.0f)) return;
    const float half_ = 0.5f * (float)size * place->cell.x;
    int outside = min(OUTSIDE_RUN, count - first);
    for (int t = first; t < min(first + OUTSIDE_RUN, count); t += LW_WIDTH) {
        __global const float* p = triangles + t;
        const mask near = and_(and_(spans_box(p, stride, place->origin.x + half_, half_), spans_box(p + stride, stride, place->origin.y + half_, half_)),
                               spans_box(p + 2 * stride, stride, place->origin.z + half_, half_));
        outside -= (int)popcount(bits_(and_(near, lanei_iota() + (lanei)(t) < (lanei)(count))));
    }
    if (outside) atomic_add(&state->outside, outside);
}
