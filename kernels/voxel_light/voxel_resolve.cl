// Words of the finest level, of surfaces and light (voxel_shade.h), for bricks where those have changed.
#include "shared/grid_types.h"
#include "shared/voxel_grid_types.h"
#include "shared/voxel_mips_types.h"
#include "shared/vpl_list.h"
#include "voxel_shade.h"

// LW_WIDTH voxels of a brick from number `first` on, in rows of 8, to rows of 9.
LW_FN void store_words(laneu word, int first, __global uint* to) {
    uint lanes[LW_WIDTH];
    store(word, lanes, 0);
#if LW_WIDTH == 1
    to[(first & 7) + 9 * (first >> 3 & 7) + 81 * (first >> 6)] = lanes[0];
#else
    for (int i = 0; i < LW_WIDTH; i += 4) {
        const int v = first + i;
        vstore4(vload4(0, lanes + i), 0, to + (v & 7) + 9 * (v >> 3 & 7) + 81 * (v >> 6));
    }
#endif
}

LW_FN laneu packed_value(const real* value, float perUnit, laneu dither) {
    return voxel_packed(value[0], value[1], value[2], value[3], perUnit, dither);
}

// One work-item = one brick. marks: voxel_light_settle's in, all levels' bricks' out.
__kernel void voxel_resolve(__global const LwGridPlace* grid, LwVoxelContents contents,
                            __global const int* bricks, __global const float* surfaces,
                            __global const LwVoxelGrid* gridState, __global const float* light,
                            __global const float* arriving, __global const int* tables, int firstEntry,
                            __global const LwVoxelWork* work, __global LwVoxelState* states, int cascade,
                            __global int* marks, __global uint* words) {
    const int brick = lw_list_index(), side = contents.size / LW_VOXEL_BRICK;
    if (brick >= side * side * side) return;
    const int given = tables[firstEntry + brick], slot = bricks[brick];
    const int mark = given >= 0 && (work->moved || marks[brick]);
    marks[brick] = mark;
    if (!mark) return;
    atomic_inc(&states[cascade].changedBricks);
    const float perUnit = states[cascade].perUnit, emission = gridState->emission,
                perFace = M_1_PI_F * grid->origin.w * grid->origin.w;
    const int x = 8 * (brick % side), y = 8 * (brick / side % side), z = 8 * (brick / (side * side));
    const int planes = voxel_base_planes(contents.mode, contents.sides),
              mean = voxel_filtered_plane(contents.mode, contents.sides);
    __global uint* to = words + given * LW_VOXEL_STRIDE;
    for (int i = 0; i < LW_VOXEL_BRICK_VOXELS; i += LW_WIDTH) {
        lw_voxels v;
        if (slot < 0 || !load_voxels(surfaces, contents, light, arriving, emission, perFace,
                                     slot * LW_VOXEL_BRICK_VOXELS + i, &v)) {
            for (int p = 0; p < planes; ++p) store_words((laneu)(0u), i, to + p * contents.planeWords);
            continue;
        }
        const lanei lane = lanei_iota() + i;
        const lanei lx = (lane & (lanei)(7)) + x, ly = (lane >> (lanei)(3) & (lanei)(7)) + y;
        const int lz = (i >> 6) + z;
        real value[13];
        if (contents.sides)
            for (int s = 0; s < LW_VOXEL_SIDES; ++s) {
                shade_side(&v, s >> 1, s & 1 ? -1.0f : 1.0f, contents.aware, value);
                store_words(packed_value(value, perUnit, voxel_dithers(lx, ly, lz, 0, s)), i,
                            to + s * contents.planeWords);
            }
        if (contents.mode == 1 && contents.sides) continue;
        if (contents.mode == 2)
            shade_harmonics(&v, value);
        else
            shade_mean(&v, value);
        store_words(packed_value(value, perUnit, voxel_dithers(lx, ly, lz, 0, mean)), i,
                    to + mean * contents.planeWords);
        if (contents.mode == 2)
            for (int c = 0; c < 3; ++c)
                store_words(
                    voxel_packed_harmonics(value[c], value[4 + 3 * c], value[5 + 3 * c],
                                           value[6 + 3 * c], voxel_dithers(lx, ly, lz, 0, mean + 1 + c)),
                    i, to + (mean + 1 + c) * contents.planeWords);
    }
}
