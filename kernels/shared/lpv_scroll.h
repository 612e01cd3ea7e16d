// Grids that move on by whole cells of the world: what was made of a cell is right wherever the grid lies, so that the cells that
// stay are kept, and those that came in are made. What is large keeps its slots in memory: cell c of the world's has slot c modulo the
// grid's size along each axis, and what comes in takes the slots of what went out. What many read is moved along.
#ifndef LW_LPV_SCROLL_H
#define LW_LPV_SCROLL_H

#include "lpv_types.h"

// Cells from the world's origin within which samples of a quarter of a cell, and the 256ths of them that vertices are rounded to, are
// whole numbers of 29 bits. Grids farther off are made anew when they move: there vertices are rounded to a 64th of a cell as it is.
#define LPV_LATTICE_REACH 131072.0f
// By how much a grid's corner may be off a whole cell, as a share of its distance in cells: the rounding of the corner, of the cells to
// a unit of length, and of their product. Less: grids that nest or snap are taken for others and made anew whenever they move.
#define LPV_LATTICE_ROUNDING 4.8e-7f

// A grid's cells among the world's, if it begins at a whole one; else all by themselves.
typedef struct {
    float from[3];   // of the lattice's cell (0, 0, 0): the world's origin, or the grid's corner
    int corner[3];   // the grid's first cell, in the lattice's
    int isWorld;
} lpv_lattice;

LW_FN void lattice_of(const lw_float4 origin, lpv_lattice* lattice) {
    const float at[3] = {origin.x, origin.y, origin.z};
    lattice->isWorld = origin.w > 0.0f;
    for (int a = 0; a < 3; ++a) {
        const float cells = at[a] * origin.w;
        const int isNear = fabs(cells) < LPV_LATTICE_REACH;
        const int whole = isNear ? (int)(cells + (cells < 0.0f ? -0.5f : 0.5f)) : 0;
        lattice->isWorld = lattice->isWorld && isNear && fabs(cells - (float)whole) <= LPV_LATTICE_ROUNDING * fabs(cells);
        lattice->corner[a] = whole;
    }
    for (int a = 0; a < 3; ++a) {
        lattice->from[a] = lattice->isWorld ? 0.0f : at[a];
        if (!lattice->isWorld) lattice->corner[a] = 0;
    }
}

LW_FN int lpv_wrap(int cell, int count) {
    const int rest = cell % count;
    return rest < 0 ? rest + count : rest;
}

// What is to be made of a grid of `count` cells (or corners) a side that lay at `last` and lies at `now`: origins, w the cells to a unit
// of length. keeps: 0 where nothing of the last one is right.
LW_FN void parts_of(const lw_float4 last, const lw_float4 now, int keeps, int count, LwLpvParts* parts) {
    lpv_lattice from, to;
    lattice_of(last, &from);
    lattice_of(now, &to);
    int low[3], high[3], isKept = keeps && from.isWorld && to.isWorld && last.w == now.w;
    for (int a = 0; a < 3; ++a) {
        const int shift = to.corner[a] - from.corner[a];
        low[a] = max(0, -shift);
        high[a] = min(count, count - shift);
        isKept = isKept && low[a] < high[a];
    }
    parts->shift = (lw_int4)(to.corner[0] - from.corner[0], to.corner[1] - from.corner[1], to.corner[2] - from.corner[2], 0);
    parts->slot = (lw_int4)(lpv_wrap(to.corner[0], count), lpv_wrap(to.corner[1], count), lpv_wrap(to.corner[2], count), 0);
    parts->count = 0;
    const lw_int4 all = (lw_int4)(count, count, count, 0);
    lw_int4 least = (lw_int4)(0), most = all;
    for (int i = 0; i < LW_LPV_PARTS; ++i) parts->low[i] = parts->high[i] = least;
    if (!isKept) {
        parts->count = 1;
        parts->high[0] = all;
        return;
    }
    // Along x what came in is whole; along y of what stayed along x, along z of what stayed along both.
    for (int a = 0; a < 3; ++a) {
        const int below = low[a] > 0, above = high[a] < count;
        if (below || above) {
            lw_int4 partLow = least, partHigh = most;
            const int begin = above ? high[a] : 0, end = above ? count : low[a];
            if (a == 0) partLow.x = begin, partHigh.x = end;
            else if (a == 1) partLow.y = begin, partHigh.y = end;
            else partLow.z = begin, partHigh.z = end;
            parts->low[parts->count] = partLow;
            parts->high[parts->count] = partHigh;
            ++parts->count;
        }
        if (a == 0) least.x = low[a], most.x = high[a];
        else if (a == 1) least.y = low[a], most.y = high[a];
    }
}

// Whether a cell is in a part; or in any.
LW_FN int part_has(lw_int4 low, lw_int4 high, int x, int y, int z) {
    return x >= low.x && x < high.x && y >= low.y && y < high.y && z >= low.z && z < high.z;
}
LW_FN int parts_have(__global const LwLpvParts* parts, int x, int y, int z) {
    int found = 0;
    for (int i = 0; i < parts->count; ++i) found = found || part_has(parts->low[i], parts->high[i], x, y, z);
    return found;
}

// Where cell (x, y, z) of a grid of `count` a side is kept. slot: LwLpvParts's.
LW_FN int slot_along(int cell, int count) { return cell < count ? cell : cell - count; }
LW_FN int slot_of(int x, int y, int z, lw_int4 slot, int count) {
    return (slot_along(z + slot.z, count) * count + slot_along(y + slot.y, count)) * count + slot_along(x + slot.x, count);
}

#endif
