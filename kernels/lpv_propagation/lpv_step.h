// One step of a light propagation volume (Kaplanyan and Dachsbacher 2010): every cell gathers what its six neighbours send
// through its five far faces of each, and sends it on as a cosine lobe about the face's normal.
//
// A face of normal f, seen from a neighbour's centre in direction d under the solid angle w pi, adds w I(d) lobe(f). I is
// *not* clamped at 0 (that would make light: 14 % in the first step), so the step is linear, and a neighbour's
// five faces are one 4 x 4 matrix. For a neighbour on the lower side of axis e, with the other axes u (faces +u and -u under
// d = (2 e +- u) / sqrt(5)):
//
//   c0'   = a c0 + b c_e              a = 1/6: the five faces see a sixth of the sphere
//   c_e'  = p c0 + q c_e
//   c_u'  = k c_u
//
// and on the upper side with -b and -p. Six neighbours take 36 operations a cell and colour in this form, against 30 faces.
//
// The sum over all steps, S_n = g + P g + ... + P^n g, needs no grid to add up in: S_(n+1) = g + P S_n.
#ifndef LW_LPV_STEP_H
#define LW_LPV_STEP_H

#include "shared/lpv_types.h"
#include "shared/wide.h"

#define LPV_A 0.1666666667f
#define LPV_B 0.2640291686f  // LOBE0 Y1 (w_front + 8 / sqrt(5) w_side)
#define LPV_P 0.0368167958f  // LOBE1 Y0 w_front
#define LPV_Q 0.0637685609f  // LOBE1 Y1 w_front
#define LPV_K 0.0602765156f  // LOBE1 Y1 w_side * 2 / sqrt(5)

// One band of the linear ones, along an axis whose neighbours are `along` floats away: what the step leaves of it.
LW_FN real linear_band(__global const float* band, int along, int u, int v, real difference, real source) {
    const real ahead = load_whole(band - along) + load_whole(band + along);
    const real beside = (load_whole(band - u) + load_whole(band + u)) + (load_whole(band - v) + load_whole(band + v));
    return fma_(LPV_P, difference, fma_(LPV_Q, ahead, fma_(LPV_K, beside, source)));
}

// Distances between cells of a grid, in floats.
typedef struct {
    int plane, row, slice;
} lpv_strides;

// LW_WIDTH cells of a row from the float `at` on, the first of a colour's planes: to = source + the step of `from`.
LW_FN void free_cells(__global const float* source, __global const float* from, __global float* to, int at, lpv_strides d) {
    __global const float* c0 = from + at;
    __global const float* cx = c0 + d.plane;
    __global const float* cy = cx + d.plane;
    __global const float* cz = cy + d.plane;
    const real xl = load_whole(c0 - 1), xh = load_whole(c0 + 1), yl = load_whole(c0 - d.row), yh = load_whole(c0 + d.row),
               zl = load_whole(c0 - d.slice), zh = load_whole(c0 + d.slice);
    const real sum = ((xl + xh) + (yl + yh)) + (zl + zh);
    const real flow = ((load_whole(cx - 1) - load_whole(cx + 1)) + (load_whole(cy - d.row) - load_whole(cy + d.row))) +
                      (load_whole(cz - d.slice) - load_whole(cz + d.slice));
    store(fma_(LPV_A, sum, fma_(LPV_B, flow, load_whole(source + at))), to, at);
    at += d.plane;
    store(linear_band(cx, 1, d.row, d.slice, xl - xh, load_whole(source + at)), to, at);
    at += d.plane;
    store(linear_band(cy, d.row, 1, d.slice, yl - yh, load_whole(source + at)), to, at);
    at += d.plane;
    store(linear_band(cz, d.slice, 1, d.row, zl - zh, load_whole(source + at)), to, at);
}

LW_FN lpv_strides strides_of(int size) {
    const lpv_strides d = {lpv_plane(size), lpv_row(size), lpv_slice(size)};
    return d;
}


// What several steps share, and what blocks light between cells; isBlocked: a constant. Without blockers the last two are not
// touched.
typedef struct {
    __global const float* source;
    int size, isBlocked;
    __global const float* faces;
    __global const int* runs;
} lpv_steps;

// Work-items leave where enough steps have been taken. watches: 0: `progress` is not looked at.
LW_FN int is_done(__global const LwLpvProgress* progress, int watches) { return watches && progress->done; }

#include "lpv_faces.h"

// LW_WIDTH cells of a row. A run of cells where nothing blocks takes the free step, at every width alike.
LW_FN void step_cells(lpv_steps s, __global const float* from, __global float* to, int colour, int x, int y, int z) {
    const lpv_strides d = strides_of(s.size);
    const int cell = lpv_cell(s.size, x, y, z), at = LW_LPV_BANDS * colour * d.plane + cell;
    if (s.isBlocked && s.runs[(z * s.size + y) * (s.size / LW_LPV_BLOCK_RUN) + x / LW_LPV_BLOCK_RUN])
        blocked_cells(s.source, from, to, at, d, s.faces + cell);
    else
        free_cells(s.source, from, to, at, d);
}

// One step. One work-item = LW_WIDTH cells of a row; rows are numbered by y, z and colour. size: a power of two. Grids' planes as
// shared/lpv_types.h lays them out, borders empty: to = source + the step of `from`.
LW_FN void one_step(lpv_steps s, __global const float* from, __global float* to) {
    const int x = (int)get_global_id(0) * LW_WIDTH, line = (int)get_global_id(1), bits = 31 - (int)clz(s.size);
    if (x >= s.size || line >= LW_LPV_COLOURS * s.size * s.size) return;
    step_cells(s, from, to, line >> 2 * bits, x, line & (s.size - 1), line >> bits & (s.size - 1));
}

// Several steps, for processors whose cores have caches of their own. Steps follow each other through the slices, each one
// slice behind the one before, so that what one leaves the next finds in the cache: step t writes slice z of one
// grid after step t - 1 has left slice z + 1 in the other, and before step t + 1 writes slice z - 1 there, which nobody needs any
// more. To share the work out, the grid is cut across z into `parts`, which lose a slice at each cut with every step; what
// is then missing about the cuts comes after (atCuts = 1), and finds there what it needs: a part stops overwriting a
// step's slice before it would be missed.
//
// One work-item = a part, or a cut, of one colour. The result is in `second` after an odd number of steps, else in `first`; the
// first step reads `from`, which may be `first`. parts * 2 * steps <= size, or parts = 1.
LW_FN void wave_of_steps(lpv_steps s, __global const float* from, __global float* first, __global float* second, int steps,
                         int parts, int atCuts) {
    const int item = (int)get_global_id(0), count = atCuts ? parts - 1 : parts;
    if (item >= LW_LPV_COLOURS * count) return;
    const int colour = item / count, part = item % count, length = s.size / parts;
    // Step t takes slices low - lowGrowth t .. high + highGrowth t - 1.
    int low = part * length, high = low + length, lowGrowth = part > 0 ? -1 : 0, highGrowth = part < parts - 1 ? -1 : 0;
    if (atCuts) {
        low = high;
        lowGrowth = highGrowth = 1;
    }
    const int start = low - (lowGrowth > 0 ? steps - 1 : 0), end = high + (highGrowth > 0 ? steps - 1 : 0);
    for (int wave = start; wave < end + steps - 1; ++wave)
        for (int t = 0; t < steps; ++t) {
            const int z = wave - t;
            if (z < low - lowGrowth * t || z >= high + highGrowth * t) continue;
            __global const float* read = t == 0 ? from : t & 1 ? second : first;
            __global float* write = t & 1 ? first : second;
            for (int y = 0; y < s.size; ++y)
                for (int x = 0; x < s.size; x += LW_WIDTH) step_cells(s, read, write, colour, x, y, z);
        }
}

#endif
