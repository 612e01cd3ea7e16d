// Light in voxels: the flux of every texel of the reflective shadow maps in the voxel that it lies in,
// as whole numbers of 64 bits, so that nothing depends on the order of additions: multiples of a power
// of two that the frame's brightest texel and the number of texels choose (LwGridPlace), with which no
// sum can overflow. A texel whose voxel holds no surface (rounding put it beside its wall) lies half a
// voxel below itself, or above.
//
// Sums are then compared with the last frame's: only bricks whose light or surfaces have changed get new
// words.
#include "shared/grid_types.h"
#include "shared/rsm_types.h"
#include "shared/voxel_grid_types.h"
#include "shared/voxel_mips_types.h"
#include "shared/vpl_list.h"
#include "shared/whole_sums.h"
#include "voxel_shade.h"

// Texels of a work-item, which adds up those of one voxel before it touches memory that others write as
// well.
#define LIGHT_RUN 64
// Half a voxel: far enough from a wall on a voxel's border to the voxel that holds the wall, too near
// for the voxel behind that one.
#define LIGHT_NUDGE 0.5f
// Of a flux: three colours' sum stays below the largest number that the grid's place is made for.
#define LIGHT_QUARTER 0.25f

// What a work-item has of one voxel.
typedef struct {
    int slot, voxel;
    long sums[LW_VOXEL_LIGHT_PLANES];
} light_run;

LW_FN void clear_run(light_run* run) {
    for (int p = 0; p < LW_VOXEL_LIGHT_PLANES; ++p) run->sums[p] = 0;
    run->slot = -1;
    run->voxel = 0;
}

LW_FN void end_run(light_run* run, int planes, __global uint* sums, __global int* touched) {
    if (run->slot < 0) return;
    __global uint* to = sums + run->slot * planes * 2 * LW_VOXEL_BRICK_VOXELS + run->voxel;
    for (int p = 0; p < planes; ++p) {
        add_long_apart(to + 2 * p * LW_VOXEL_BRICK_VOXELS, to + (2 * p + 1) * LW_VOXEL_BRICK_VOXELS,
                       run->sums[p]);
        run->sums[p] = 0;
    }
    atomic_or(touched + run->slot, LW_LIGHT_TOUCHED);
}

// The voxel of a place in voxels of the grid: its number in its brick, and the brick's slot of surfaces;
// -1: beyond the grid, or without surface.
LW_FN int find_voxel(float x, float y, float z, int size, __global const int* bricks,
                     __global const float* surfaces, int slots, int* voxel) {
    const float most = (float)size;
    if (!(x >= 0.0f && x < most && y >= 0.0f && y < most && z >= 0.0f && z < most)) return -1;
    const int i = (int)x, j = (int)y, k = (int)z, side = size / LW_VOXEL_BRICK;
    const int slot = bricks[((k >> 3) * side + (j >> 3)) * side + (i >> 3)];
    *voxel = (i & 7) | (j & 7) << 3 | (k & 7) << 6;
    if (slot < 0) return -1;
    return surfaces[(LW_SURFACE_AREA * slots + slot) * LW_VOXEL_BRICK_VOXELS + *voxel] > 0.0f ? slot
                                                                                              : -1;
}

// One work-item = LIGHT_RUN texels of all maps.
__kernel void voxel_light_inject(__global const float* texels, int4 layout, int count,
                                 __global const LwGridPlace* grid, LwVoxelContents contents,
                                 __global const int* bricks, __global const float* surfaces,
                                 __global uint* sums, __global int* touched,
                                 __global LwVoxelTexels* state) {
    const int first = lw_list_index() * LIGHT_RUN, last = min(first + LIGHT_RUN, count),
              stride = layout.z, size = contents.size;
    const LwGridPlace place = *grid;
    const float inverse = place.origin.w, most = (float)size, first_ = place.cell.y * LIGHT_QUARTER,
                second = place.cell.z;
    light_run run;
    clear_run(&run);
    int outside = 0, lost = 0;
    for (int i = first; i < last; ++i) {
        __global const float* p = texels + layout.x + i;
        const float flux[3] = {p[LW_RSM_FLUX * stride], p[(LW_RSM_FLUX + 1) * stride],
                               p[(LW_RSM_FLUX + 2) * stride]};
        if (!(fmax(fmax(flux[0], flux[1]), flux[2]) > 0.0f)) continue;
        const float n[3] = {p[LW_RSM_NORMAL * stride], p[(LW_RSM_NORMAL + 1) * stride],
                            p[(LW_RSM_NORMAL + 2) * stride]};
        const float x = (p[LW_RSM_POSITION * stride] - place.origin.x) * inverse,
                    y = (p[(LW_RSM_POSITION + 1) * stride] - place.origin.y) * inverse,
                    z = (p[(LW_RSM_POSITION + 2) * stride] - place.origin.z) * inverse;
        int voxel = 0, slot = inverse > 0.0f
                                  ? find_voxel(x, y, z, size, bricks, surfaces, contents.slots, &voxel)
                                  : -1;
        for (int side = 0; side < 2 && slot < 0 && inverse > 0.0f; ++side) {
            const float nudge = side ? LIGHT_NUDGE : -LIGHT_NUDGE;
            slot = find_voxel(x + nudge * n[0], y + nudge * n[1], z + nudge * n[2], size, bricks,
                              surfaces, contents.slots, &voxel);
        }
        if (slot < 0) {
            const int inside = inverse > 0.0f && x >= 0.0f && x < most && y >= 0.0f && y < most &&
                               z >= 0.0f && z < most;
            lost += inside;
            outside += !inside;
            continue;
        }
        if (slot != run.slot || voxel != run.voxel) {
            end_run(&run, contents.planes, sums, touched);
            run.slot = slot;
            run.voxel = voxel;
        }
        _Pragma("unroll") for (int c = 0; c < 3; ++c) run.sums[LW_LIGHT_FLUX + c] +=
            (long)(flux[c] * first_ * second);
        if (contents.planes == LW_LIGHT_DIRECTION) continue;
        const float all = flux[0] + flux[1] + flux[2];
        _Pragma("unroll") for (int c = 0; c < 3; ++c) run.sums[LW_LIGHT_DIRECTION + c] +=
            (long)(all * n[c] * first_ * second);
    }
    end_run(&run, contents.planes, sums, touched);
    if (outside) atomic_add(&state->outside, outside);
    if (lost) atomic_add(&state->lost, lost);
}

// One slot's sums as floats: what they come to against what they were. Sums begin anew at 0. True:
// something has changed.
LW_FN int settle_light(int slot, LwVoxelContents contents, float first, float second,
                       __global uint* sums, __global float* light) {
    const int plane = contents.slots * LW_VOXEL_BRICK_VOXELS;
    mask differs = splat_mask(0);
    for (int p = 0; p < contents.planes; ++p) {
        __global uint* low = sums + (slot * contents.planes + p) * 2 * LW_VOXEL_BRICK_VOXELS;
        __global uint* high = low + LW_VOXEL_BRICK_VOXELS;
        __global float* to = light + p * plane + slot * LW_VOXEL_BRICK_VOXELS;
        for (int i = 0; i < LW_VOXEL_BRICK_VOXELS; i += LW_WIDTH) {
            const real whole =
                fma_(to_real(as_lanei_(loadi(high, i))), 4294967296.0f, to_real(loadi(low, i)));
            const real value = whole * first * second;
            differs = or_(differs, load(to, i) != value);
            store(value, to, i);
            store((laneu)(0u), low, i);
            store((laneu)(0u), high, i);
        }
    }
    return any_(differs);
}

// The largest premultiplied colour of a slot's voxels.
LW_FN float largest_of(int slot, LwVoxelContents contents, __global const float* surfaces,
                       __global const float* light, __global const float* arriving, float emission,
                       float perFace) {
    real largest = (real)(0.0f);
    for (int i = 0; i < LW_VOXEL_BRICK_VOXELS; i += LW_WIDTH) {
        lw_voxels v;
        if (!load_voxels(surfaces, contents, light, arriving, emission, perFace,
                         slot * LW_VOXEL_BRICK_VOXELS + i, &v))
            continue;
        real value[13];
        if (contents.sides)
            for (int side = 0; side < LW_VOXEL_SIDES; ++side) {
                shade_side(&v, side >> 1, side & 1 ? -1.0f : 1.0f, contents.aware, value);
                largest = fmax(largest, fmax(fmax(value[0], value[1]), value[2]));
            }
        if (contents.mode == 2)
            shade_harmonics(&v, value);
        else
            shade_mean(&v, value);
        largest = fmax(largest, fmax(fmax(value[0], value[1]), value[2]));
    }
    return max_lane(largest);
}

// One work-item = one brick. all: whatever has changed. marks: of bricks with surfaces, whether their
// light or they have changed.
__kernel void voxel_light_settle(__global const LwGridPlace* grid, LwVoxelContents contents, int all,
                                 __global const int* bricks, __global const float* surfaces,
                                 __global const int* changed, __global const LwVoxelGrid* gridState,
                                 __global uint* sums, __global int* touched, __global float* light,
                                 __global const float* arriving, __global float* largest,
                                 __global int* marks, __global LwVoxelState* states, int cascade) {
    const int brick = lw_list_index(), side = contents.size / LW_VOXEL_BRICK;
    if (brick >= side * side * side) return;
    const int slot = bricks[brick], isNew = all || changed[brick];
    int mark = isNew;
    float most = 0.0f;
    if (slot >= 0) {
        const LwGridPlace place = *grid;
        const int was = touched[slot];
        if (was & (LW_LIGHT_TOUCHED | LW_LIGHT_LIT))
            mark |= settle_light(slot, contents, 1.0f / (place.cell.y * LIGHT_QUARTER),
                                 1.0f / place.cell.z, sums, light);
        mark |= (was & LW_LIGHT_HEARD) != 0;
        touched[slot] = was & LW_LIGHT_TOUCHED ? LW_LIGHT_LIT : 0;
        if (mark)
            largest[brick] = largest_of(slot, contents, surfaces, light, arriving, gridState->emission,
                                        M_1_PI_F * place.origin.w * place.origin.w);
        most = largest[brick];
    }
    marks[brick] = mark;
    if (most > 0.0f) atomic_max(&states[cascade].largest, as_int(most));
}

// One work-item in all: what the words are in. Another unit: all words are written anew.
__kernel void voxel_light_unit(__global LwVoxelState* states, int cascade, __global LwVoxelWork* work) {
    if (get_global_id(0) != 0) return;
    __global LwVoxelState* state = states + cascade;
    const float largest = as_float(state->largest);
    if (!(largest > 0.0f)) {
        if (state->perUnit > 0.0f) return;  // nothing shines: any unit will do
    }
    const int exponent = voxel_unit_exponent(largest), unit = voxel_unit(exponent);
    if (unit == state->unit) return;
    state->unit = unit;
    state->perUnit = voxel_per_unit(exponent);
    work->moved = 1;
}
