// Coarser levels of lit voxels (docs/techniques/voxel_mips.md), each from the words of the one below.
//
// Isotropic: premultiplied light and opacity are means of eight children, so that each level's total is
// the one's below. A wall one voxel thick has opacity 2^-k on level k. Six sides (Crassin et al. 2011):
// the two children that a ray along an axis meets one after the other are composed front to back, f + (1
// - opacity of f) b, and four such columns averaged: the wall stays opaque for rays across it. SH2:
// means, as isotropic ones. Only octants of bricks are filtered whose child brick has changed.
#include "shared/voxel_format_wide.h"
#include "shared/voxel_mips_types.h"

LW_FN int slot_at(__global const int* table, int side, int x, int y, int z) {
    return x < side && y < side && z < side ? table[(z * side + y) * side + x] : LW_VOXEL_EMPTY;
}

// One work-item = one brick of a level (x) and plane (y): copies what it stores of its upper neighbours,
// where those or it have changed.
__kernel void voxel_mips_apron(__global const int* tables, int firstBrick, int side,
                               __global const LwVoxelWork* work, __global const int* marks,
                               int firstMark, int planes, int planeWords, __global uint* words) {
    __global const int* table = tables + firstBrick;
    __global const int* dirty = marks + firstMark;
    const int brick = (int)get_global_id(0), plane = (int)get_global_id(1);
    if (brick >= side * side * side || plane >= planes || table[brick] < 0) return;
    const int x = brick % side, y = brick / side % side, z = brick / (side * side);
    int any_ = work->moved;
    for (int towards = 0; towards < 8 && !any_; ++towards) {
        const int nx = x + (towards & 1), ny = y + (towards >> 1 & 1), nz = z + (towards >> 2);
        any_ = nx < side && ny < side && nz < side && dirty[(nz * side + ny) * side + nx];
    }
    if (!any_) return;
    __global uint* base = words + plane * planeWords;
    __global uint* to = base + table[brick] * LW_VOXEL_STRIDE;
    for (int towards = 1; towards < 8; ++towards) {
        const int dx = towards & 1, dy = towards >> 1 & 1, dz = towards >> 2;
        const int slot = slot_at(table, side, x + dx, y + dy, z + dz);
        __global const uint* from = base + max(slot, 0) * LW_VOXEL_STRIDE;
        const uint kept = slot < 0 ? 0u : 0xffffffffu;
        for (int k = 0; k < (dz ? 1 : LW_VOXEL_BRICK); ++k)
            for (int j = 0; j < (dy ? 1 : LW_VOXEL_BRICK); ++j) {
                const int row = 9 * j + 81 * k, at = row + 8 * dx + 72 * dy + 648 * dz;
                if (dx)
                    to[at] = from[row] & kept;
                else
                    vstore8(vload8(0, from + row) & kept, 0, to + at);
            }
    }
}

// What one work-item filters: an octant of a brick, whose child is one brick.
typedef struct {
    int to;                   // first word of the brick's slot
    int from;                 // of the child's; -1: none
    int ox, oy, oz, x, y, z;  // the octant's first voxel in the brick, and the brick's in the grid
} voxel_octant;

// Of work-item `item`; 0: nothing to do. Marks bricks that are filtered.
LW_FN int find_octant(int item, LwVoxelFilter filter, __global const int* tables,
                      __global const LwVoxelWork* work, __global int* marks,
                      __global LwVoxelState* state, voxel_octant* octant) {
    const int brick = item >> 3, o = item & 7, side = filter.side, fineSide = filter.fineSide;
    __global const int* table = tables + filter.table;
    __global const int* fineTable = tables + filter.fineTable;
    if (brick >= side * side * side || table[brick] < 0) return 0;
    const int x = brick % side, y = brick / side % side, z = brick / (side * side), ox = o & 1,
              oy = o >> 1 & 1, oz = o >> 2;
    int child = -1;
    if (fineSide > 1)
        child = ((2 * z + oz) * fineSide + 2 * y + oy) * fineSide + 2 * x + ox;
    else if (o == 0)
        child = 0;
    if (!work->moved && (child < 0 || !marks[filter.fineMarks + child])) return 0;
    if (atomic_or(marks + filter.marks + brick, 1) == 0) atomic_inc(&state->filteredBricks);
    octant->to = table[brick] * LW_VOXEL_STRIDE;
    octant->from =
        child < 0 || fineTable[child] < 0 ? -1 : filter.fineFirst + fineTable[child] * LW_VOXEL_STRIDE;
    octant->ox = 4 * ox;
    octant->oy = 4 * oy;
    octant->oz = 4 * oz;
    octant->x = LW_VOXEL_BRICK * x;
    octant->y = LW_VOXEL_BRICK * y;
    octant->z = LW_VOXEL_BRICK * z;
    return 1;
}

// Lanes l of a slice's 16 voxels: l & 3, l >> 2. What they are in the child's slice 0, and whether the
// level has them.
LW_FN lanei child_voxel(lanei lane) {
    return (lane & (lanei)(3)) * 2 + (lane >> (lanei)(2)) * 18;
}
LW_FN mask in_level(const voxel_octant* o, lanei lane, int voxels) {
    return and_(lane - (lane >> (lanei)(2)) * 4 + o->ox < (lanei)(voxels),
                (lane >> (lanei)(2)) + o->oy < (lanei)(voxels));
}
LW_FN laneu dithers_of(const voxel_octant* o, lanei lane, int slice, int level, int plane) {
    return voxel_dithers((lane & (lanei)(3)) + (lanei)(o->x + o->ox),
                         (lane >> (lanei)(2)) + (lanei)(o->y + o->oy), o->z + o->oz + slice, level,
                         plane);
}
LW_FN laneu words_at(__global const uint* words, lanei at) {
    return as_laneu_(gatheri((__global const int*)words, at));
}

// Child c's offset: bits 0, 1, 2 along x, y, z.
LW_FN int child_offset(int c) {
    return (c & 1) + 9 * (c >> 1 & 1) + 81 * (c >> 2);
}

// Writes the words of lanes `first`.. of a slice; 0 where the level has no such voxel.
LW_FN void store_slice(laneu word, mask inside, const voxel_octant* o, int first, int slice,
                       __global uint* to) {
    uint lanes[LW_WIDTH];
    store(selectu_((laneu)(0u), word, inside), lanes, 0);
    __global uint* base = to + o->to + o->ox + 9 * o->oy + 81 * (o->oz + slice);
    for (int i = 0; i < LW_WIDTH; ++i) base[((first + i) & 3) + 9 * ((first + i) >> 2)] = lanes[i];
}

// One work-item = one octant of a brick of the level that is made.
__kernel void voxel_mips_isotropic(LwVoxelFilter filter, __global const int* tables,
                                   __global const uint* fine, __global const LwVoxelWork* work,
                                   __global int* marks, __global LwVoxelState* states, int grid,
                                   __global uint* to) {
    __global LwVoxelState* state = states + grid;
    voxel_octant o;
    if (!find_octant((int)get_global_id(0), filter, tables, work, marks, state, &o)) return;
    const int unit = state->unit;
    const float perUnit = state->perUnit;
    for (int slice = 0; slice < 4; ++slice)
        for (int first = 0; first < 16; first += LW_WIDTH) {
            const lanei lane = lanei_iota() + first;
            const mask inside = and_(in_level(&o, lane, filter.voxels),
                                     splat_mask(o.from >= 0 && o.oz + slice < filter.voxels));
            laneu word = (laneu)(0u);
            if (o.from >= 0) {
                real sum[4] = {(real)(0.0f), (real)(0.0f), (real)(0.0f), (real)(0.0f)};
                const lanei at = child_voxel(lane) + (o.from + 162 * slice);
                for (int c = 0; c < 8; ++c)
                    voxel_add(words_at(fine, at + child_offset(c)), unit, (real)(0.125f), sum);
                voxel_scale(sum);
                word = voxel_packed(sum[0], sum[1], sum[2], sum[3], perUnit,
                                    dithers_of(&o, lane, slice, filter.level, 0));
            }
            store_slice(word, inside, &o, first, slice, to);
        }
}

// The same with SH2's four planes.
__kernel void voxel_mips_harmonics(LwVoxelFilter filter, __global const int* tables,
                                   __global const uint* fine, __global const LwVoxelWork* work,
                                   __global int* marks, __global LwVoxelState* states, int grid,
                                   __global uint* to) {
    __global LwVoxelState* state = states + grid;
    voxel_octant o;
    if (!find_octant((int)get_global_id(0), filter, tables, work, marks, state, &o)) return;
    const int unit = state->unit;
    const float perUnit = state->perUnit;
    for (int slice = 0; slice < 4; ++slice)
        for (int first = 0; first < 16; first += LW_WIDTH) {
            const lanei lane = lanei_iota() + first;
            const mask inside = and_(in_level(&o, lane, filter.voxels),
                                     splat_mask(o.from >= 0 && o.oz + slice < filter.voxels));
            real sum[13];
            for (int i = 0; i < 13; ++i) sum[i] = (real)(0.0f);
            if (o.from >= 0) {
                const lanei at = child_voxel(lane) + (o.from + 162 * slice);
                for (int c = 0; c < 8; ++c) {
                    const lanei child = at + child_offset(c);
                    voxel_add_harmonics(words_at(fine, child), words_at(fine + filter.finePlane, child),
                                        words_at(fine + 2 * filter.finePlane, child),
                                        words_at(fine + 3 * filter.finePlane, child), unit,
                                        (real)(0.125f), sum);
                }
                voxel_scale_harmonics(sum);
            }
            const laneu word = voxel_packed(sum[0], sum[1], sum[2], sum[3], perUnit,
                                            dithers_of(&o, lane, slice, filter.level, 0));
            store_slice(word, inside, &o, first, slice, to);
            for (int c = 0; c < 3; ++c)
                store_slice(
                    voxel_packed_harmonics(sum[c], sum[4 + 3 * c], sum[5 + 3 * c], sum[6 + 3 * c],
                                           dithers_of(&o, lane, slice, filter.level, 1 + c)),
                    inside, &o, first, slice, to + (1 + c) * filter.plane);
        }
}

// One side of LW_WIDTH voxels. front: 1 where its rays meet the upper child along `axis` first.
LW_FN void compose_side(__global const uint* fine, lanei at, int axis, int front, int unit, real* sum) {
    const int along = 1 << axis, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    for (int column = 0; column < 4; ++column) {
        const int first = (column & 1 ? u : 0) | (column & 2 ? v : 0);
        const lanei near = at + child_offset(first | (front ? along : 0)),
                    far = at + child_offset(first | (front ? 0 : along));
        const laneu nearWord = words_at(fine, near), farWord = words_at(fine, far);
        const real through = 1.0f - voxel_field(nearWord, LW_VOXEL_OPACITY_MASK) * LW_VOXEL_OPACITY_STEP;
        voxel_add(nearWord, unit, (real)(0.25f), sum);
        voxel_add(farWord, unit, 0.25f * fmax(through, (real)(0.0f)), sum);
    }
}

// The same with six sides.
__kernel void voxel_mips_sides(LwVoxelFilter filter, __global const int* tables,
                               __global const uint* fine, __global const LwVoxelWork* work,
                               __global int* marks, __global LwVoxelState* states, int grid,
                               __global uint* to) {
    __global LwVoxelState* state = states + grid;
    voxel_octant o;
    if (!find_octant((int)get_global_id(0), filter, tables, work, marks, state, &o)) return;
    const int unit = state->unit;
    const float perUnit = state->perUnit;
    for (int slice = 0; slice < 4; ++slice)
        for (int first = 0; first < 16; first += LW_WIDTH) {
            const lanei lane = lanei_iota() + first;
            const mask inside = and_(in_level(&o, lane, filter.voxels),
                                     splat_mask(o.from >= 0 && o.oz + slice < filter.voxels));
            for (int s = 0; s < LW_VOXEL_SIDES; ++s) {
                laneu word = (laneu)(0u);
                if (o.from >= 0) {
                    real sum[4] = {(real)(0.0f), (real)(0.0f), (real)(0.0f), (real)(0.0f)};
                    // Rays that go down an axis meet the upper child first.
                    compose_side(fine + s * filter.finePlane, child_voxel(lane) + (o.from + 162 * slice),
                                 s >> 1, !(s & 1), unit, sum);
                    voxel_scale(sum);
                    word = voxel_packed(sum[0], sum[1], sum[2], fmin(sum[3], (real)(1.0f)), perUnit,
                                        dithers_of(&o, lane, slice, filter.level, s));
                }
                store_slice(word, inside, &o, first, slice, to + s * filter.plane);
            }
        }
}
