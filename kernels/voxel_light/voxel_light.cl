// Light in voxels: the flux of the texels that lie in each (voxel_texels.cl), as whole numbers of 64 bits,
// so that nothing depends on the order of additions: multiples of a power of two that the frame's
// brightest texel and the number of texels choose (LwGridPlace), with which no sum can overflow.
//
// Sums are then compared with the last frame's: only bricks whose light or surfaces have changed get new
// words.
#include "shared/grid_types.h"
#include "shared/voxel_grid_types.h"
#include "shared/voxel_mips_types.h"
#include "shared/vpl_list.h"
#include "voxel_shade.h"

// Of a flux: three colours' sum stays below the largest number that the grid's place is made for.
#define LIGHT_QUARTER 0.25f

// Sums of one brick: those of 32 voxels are there where some bit of `lit` is.
typedef struct {
    long of[LW_VOXEL_LIGHT_PLANES * LW_VOXEL_BRICK_VOXELS];
    uint lit[LW_LIGHT_LIT_WORDS];
} light_sums;

// Texels `from` to `to` of the sorted ones.
LW_FN void add_texels(int from, int to_, LwVoxelContents contents, float first, float second,
                      __global const uint* records, __global const int* order, light_sums* sums) {
    const int stride = voxel_record(contents.planes);
    for (int i = from; i < to_; ++i) {
        __global const uint* record = records + order[i] * stride;
        const int voxel = (int)((record[0] - 1u) % LW_VOXEL_BRICK_VOXELS), group = voxel >> 5;
        if (sums->lit[group] == 0)
            for (int p = 0; p < contents.planes; ++p)
                for (int v = 0; v < 32; ++v) sums->of[p * LW_VOXEL_BRICK_VOXELS + 32 * group + v] = 0;
        sums->lit[group] |= 1u << (voxel & 31);
        const float flux[3] = {as_float(record[1]), as_float(record[2]), as_float(record[3])};
        long* to = sums->of + voxel;
        LW_UNROLL for (int c = 0; c < 3; ++c) to[(LW_LIGHT_FLUX + c) * LW_VOXEL_BRICK_VOXELS] +=
            (long)(flux[c] * first * second);
        if (contents.planes == LW_LIGHT_DIRECTION) continue;
        const float all = flux[0] + flux[1] + flux[2];
        LW_UNROLL for (int c = 0; c < 3; ++c) to[(LW_LIGHT_DIRECTION + c) * LW_VOXEL_BRICK_VOXELS] +=
            (long)(all * as_float(record[4 + c]) * first * second);
    }
}

// One slot's light, of its texels. lit: voxels that held some, and hold some; what holds none is 0.
// True: something has changed.
LW_FN int settle_light(int slot, LwVoxelContents contents, int texels, float first, float second,
                       __global const uint* records, __global const int* order,
                       __global const int* ends, __global uint* lit, __global float* light) {
    light_sums sums;
    for (int w = 0; w < LW_LIGHT_LIT_WORDS; ++w) sums.lit[w] = 0;
    for (int row = 0; texels && row < LW_LIGHT_ROWS; ++row) {
        __global const int* end = ends + row * contents.slots + slot;
        const int from = slot ? end[-1] : voxel_light_row(row, texels);
        add_texels(from, *end, contents, first, second, records, order, &sums);
    }
    const float perFirst = 1.0f / first, perSecond = 1.0f / second;
    mask differs = splat_mask(0);
    for (int w = 0; w < LW_LIGHT_LIT_WORDS; ++w) {
        __global uint* was = lit + slot * LW_LIGHT_LIT_WORDS + w;
        if (*was == 0 && sums.lit[w] == 0) continue;
        *was = sums.lit[w];
        for (int p = 0; p < contents.planes; ++p) {
            __global float* to = light + (p * contents.slots + slot) * LW_VOXEL_BRICK_VOXELS + 32 * w;
            const long* from = sums.of + p * LW_VOXEL_BRICK_VOXELS + 32 * w;
            for (int v = 0; v < 32; v += LW_WIDTH) {
                real value = (real)(0.0f);
                if (sums.lit[w]) value = to_real(load(from, v)) * perFirst * perSecond;
                differs = or_(differs, load(to, v) != value);
                store(value, to, v);
            }
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
                                 __global const LwVoxelTexels* texels, int count,
                                 __global const uint* records, __global const int* order,
                                 __global const int* ends, __global uint* lit,
                                 __global int* touched, __global float* light,
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
        const int isOther = texels->first != place.cell.y || texels->second != place.cell.z;
        if (isOther || was & LW_LIGHT_TOUCHED)
            mark |= settle_light(slot, contents, count, place.cell.y * LIGHT_QUARTER, place.cell.z,
                                 records, order, ends, lit, light);
        mark |= (was & LW_LIGHT_HEARD) != 0;
        if (was) touched[slot] = 0;
        if (mark)
            largest[brick] = largest_of(slot, contents, surfaces, light, arriving, gridState->emission,
                                        M_1_PI_F * place.origin.w * place.origin.w);
        most = largest[brick];
    }
    marks[brick] = mark;
    if (most > 0.0f) atomic_max(&states[cascade].largest, as_int(most));
}

// One work-item in all: what the words are in. Another unit: all words are written anew.
__kernel void voxel_light_unit(__global const LwGridPlace* grid, __global LwVoxelTexels* texels,
                               __global LwVoxelState* states, int cascade, __global LwVoxelWork* work) {
    if (get_global_id(0) != 0) return;
    texels->first = grid->cell.y;
    texels->second = grid->cell.z;
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
