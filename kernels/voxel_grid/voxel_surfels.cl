// The voxels of a grid that surfels touch, and the area of these in each: as voxel_triangles.cl of triangles. A disc is the regular
// octagon of its area, one smaller than a voxel all in its centre's.
#include "shared/voxel_bins.h"
#include "shared/voxel_fill.h"

typedef struct {
    __global const float* planes;
    int stride, emits;
    float4 origin;
    float perEmission;
} lw_surfels;

// Where a small surfel lies among a task's voxels; IN_OTHERS: none of it is there; IN_SEVERAL: some may be.
#define IN_OTHERS (-1)
#define IN_SEVERAL (-2)
LW_FN int small_at(const lw_surfels* s, int i, const lw_task* task) {
    __global const float* p = s->planes + i;
    const float radius = p[LW_SURFEL_RADIUS * s->stride] * s->origin.w, reach = radius * OCTAGON_REACH + 0.01f;
    const float c[3] = {(p[LW_SURFEL_POSITION * s->stride] - s->origin.x) * s->origin.w,
                        (p[(LW_SURFEL_POSITION + 1) * s->stride] - s->origin.y) * s->origin.w,
                        (p[(LW_SURFEL_POSITION + 2) * s->stride] - s->origin.z) * s->origin.w};
    if (radius < SURFEL_SMALL) {
        const int voxel[3] = {(int)c[0], (int)c[1], (int)c[2]};
        return place_in(task, voxel);
    }
    int near = 1;
    for (int a = 0; a < 3; ++a) {
        const float low = (float)(task->corner[a] + (a == 2 ? task->first : 0)),
                    high = (float)(task->corner[a] + (a == 2 ? task->last + 1 : LW_VOXEL_BRICK));
        near = near && c[a] + reach >= low && c[a] - reach <= high;
    }
    return near ? IN_SEVERAL : IN_OTHERS;
}

// A frame about the normal (Duff et al. 2017).
LW_FN void octagon_of(const lw_surfels* s, int i, lw_facet* f) {
    __global const float* p = s->planes + i;
    const float nx = p[LW_SURFEL_NORMAL * s->stride], ny = p[(LW_SURFEL_NORMAL + 1) * s->stride], nz = p[(LW_SURFEL_NORMAL + 2) * s->stride];
    const float sign = nz >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + nz), b = nx * ny * a;
    const float u[3] = {1.0f + sign * nx * nx * a, sign * b, -sign * nx}, v[3] = {b, sign + ny * ny * a, -ny};
    const float radius = p[LW_SURFEL_RADIUS * s->stride] * s->origin.w, reach = radius * OCTAGON_REACH, half_ = M_SQRT1_2_F;
    const float cosines[FACET_VERTICES] = {1.0f, half_, 0.0f, -half_, -1.0f, -half_, 0.0f, half_},
                sines[FACET_VERTICES] = {0.0f, half_, 1.0f, half_, 0.0f, -half_, -1.0f, -half_};
    const float corner[3] = {s->origin.x, s->origin.y, s->origin.z};
    f->count = FACET_VERTICES;
    f->n[0] = nx;
    f->n[1] = ny;
    f->n[2] = nz;
    f->area = M_PI_F * radius * radius;
    for (int c = 0; c < 3; ++c) {
        f->base[c] = (p[(LW_SURFEL_POSITION + c) * s->stride] - corner[c]) * s->origin.w + reach * u[c];
        for (int k = 0; k < FACET_VERTICES; ++k) f->at[k][c] = reach * ((cosines[k] - 1.0f) * u[c] + sines[k] * v[c]);
    }
    bound_facet(f);
}

LW_FN void coat_of(const lw_surfels* s, int i, lw_coat* coat) {
    __global const float* p = s->planes + i;
    const uint word = as_uint(p[LW_SURFEL_ALBEDO * s->stride]);
    coat->emits = 0;
    for (int c = 0; c < 3; ++c) {
        coat->n[c] = p[(LW_SURFEL_NORMAL + c) * s->stride];
        coat->albedo[c] = (float)(word >> (10 * c) & 1023u) * (1.0f / 1023.0f);
        coat->emission[c] = s->emits ? p[(LW_SURFEL_EMISSION + c) * s->stride] * s->perEmission : 0.0f;
        coat->emits |= coat->emission[c] > 0.0f;
    }
}

// The lists that a task looks through: its own brick's first one, the second ones of the 27 around, those of large discs.
#define TASK_LISTS 29
LW_FN int task_list(const lw_task* task, int size, int i) {
    const int side = bin_side(size), own = ((task->corner[2] / LW_VOXEL_BRICK + 1) * side + task->corner[1] / LW_VOXEL_BRICK + 1) * side +
                                           task->corner[0] / LW_VOXEL_BRICK + 1;
    if (i == 0) return 2 * own;
    if (i == TASK_LISTS - 1) return 2 * large_bin(size) + 1;
    const int k = i - 1;
    return 2 * (own + ((k / 9 - 1) * side + k / 3 % 3 - 1) * side + k % 3 - 1) + 1;
}

// As voxel_triangles_occupy.
__kernel void voxel_surfels_occupy(__global const float* surfels, int stride, __global const int* begins, __global const int* order,
                                   __global const LwLpvPlace* place, int size, __global const int* list, __global uint* occupied,
                                   __global const LwVoxelGrid* state) {
    if (!state->stale) return;
    const lw_surfels s = {surfels, stride, 0, place->origin, 0.0f};
    for (int i = (int)get_global_id(0); i < state->todo * FILL_TASKS; i += (int)get_global_size(0)) {
        lw_task task;
        task_of(list[i / FILL_TASKS], i % FILL_TASKS, size, place, &task);
        uint words[FILL_WORDS];
        for (int w = 0; w < FILL_WORDS; ++w) words[w] = 0;
        for (int l = 0; l < TASK_LISTS && s.origin.w > 0.0f; ++l) {
            const int bin = task_list(&task, size, l);
            for (int k = begins[bin]; k < begins[bin + 1]; ++k) {
                const int at = small_at(&s, order[k], &task);
                if (at >= 0) words[at >> 5] |= 1u << (at & 31);
                if (at != IN_SEVERAL) continue;
                lw_facet f;
                octagon_of(&s, order[k], &f);
                occupy_task(&f, &task, words);
            }
        }
        for (int w = 0; w < FILL_WORDS; ++w) occupied[LW_VOXEL_WORDS * task.brick + FILL_WORDS * task.part + w] = words[w];
    }
}

// As voxel_triangles_fill.
__kernel void voxel_surfels_fill(__global const float* surfels, int stride, int emits, __global const int* begins,
                                 __global const int* order, __global const LwLpvPlace* place, int size, __global const int* list,
                                 __global const int* bricks, int slots, __global uint* surfaces, __global const LwVoxelGrid* state) {
    if (!state->stale) return;
    const lw_surfels s = {surfels, stride, emits, place->origin, 1.0f / state->emission};
    for (int i = (int)get_global_id(0); i < state->todo * FILL_TASKS; i += (int)get_global_size(0)) {
        const int slot = bricks[list[i / FILL_TASKS]];
        if (slot < 0) continue;
        lw_task task;
        task_of(list[i / FILL_TASKS], i % FILL_TASKS, size, place, &task);
        long sums[FILL_VOXELS * SURFACE_SUMS];
        for (int k = 0; k < FILL_VOXELS * SURFACE_SUMS; ++k) sums[k] = 0;
        for (int l = 0; l < TASK_LISTS && s.origin.w > 0.0f; ++l) {
            const int bin = task_list(&task, size, l);
            for (int k = begins[bin]; k < begins[bin + 1]; ++k) {
                const int at = small_at(&s, order[k], &task);
                if (at == IN_OTHERS) continue;
                lw_coat coat;
                coat_of(&s, order[k], &coat);
                if (at >= 0) {
                    const float radius = surfels[LW_SURFEL_RADIUS * stride + order[k]] * s.origin.w;
                    add_area(M_PI_F * radius * radius, &coat, sums + SURFACE_SUMS * at);
                    continue;
                }
                lw_facet f;
                octagon_of(&s, order[k], &f);
                fill_task(&f, &coat, &task, sums);
            }
        }
        store_sums(sums, &task, slot, slots, surfaces);
    }
}
