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
#include "shared/lpv_types.h"
#include "shared/wide.h"

#define LPV_A 0.1666666667f
#define LPV_B 0.2640291686f  // LOBE0 Y1 (w_front + 8 / sqrt(5) w_side)
#define LPV_P 0.0368167958f  // LOBE1 Y0 w_front
#define LPV_Q 0.0637685609f  // LOBE1 Y1 w_front
#define LPV_K 0.0602765156f  // LOBE1 Y1 w_side * 2 / sqrt(5)

// One band of the linear ones, along an axis whose neighbours are `along` floats away: what the step leaves of it.
LW_FN real linear_band(__global const float* band, int along, int u, int v, real difference, real source) {
    const real ahead = load(band, -along) + load(band, along);
    const real beside = (load(band, -u) + load(band, u)) + (load(band, -v) + load(band, v));
    return fma_(LPV_P, difference, fma_(LPV_Q, ahead, fma_(LPV_K, beside, source)));
}

// One work-item = LW_WIDTH cells of a row, of `lines` rows from `firstLine` on: numbered by y, z and colour. Grids' planes as
// shared/lpv_types.h lays them out, borders empty: to = source + the step of `from`.
__kernel void lpv_propagation_step(__global const float* source, __global const float* from, __global float* to, int size,
                                   int firstLine, int lines) {
    const int x = (int)get_global_id(0) * LW_WIDTH, item = (int)get_global_id(1);
    if (x >= size || item >= lines) return;
    const int line = firstLine + item, y = line % size, z = line / size % size, colour = line / (size * size);
    const int plane = lpv_plane(size), row = lpv_row(size), slice = lpv_slice(size);
    const int at = LW_LPV_BANDS * colour * plane + lpv_cell(size, x, y, z);
    __global const float* c0 = from + at;
    __global const float* cx = c0 + plane;
    __global const float* cy = cx + plane;
    __global const float* cz = cy + plane;

    const real xl = load(c0, -1), xh = load(c0, 1), yl = load(c0, -row), yh = load(c0, row), zl = load(c0, -slice),
               zh = load(c0, slice);
    const real sum = ((xl + xh) + (yl + yh)) + (zl + zh);
    const real flow = ((load(cx, -1) - load(cx, 1)) + (load(cy, -row) - load(cy, row))) + (load(cz, -slice) - load(cz, slice));
    store(fma_(LPV_A, sum, fma_(LPV_B, flow, load(source, at))), to, at);
    store(linear_band(cx, 1, row, slice, xl - xh, load(source, at + plane)), to, at + plane);
    store(linear_band(cy, row, 1, slice, yl - yh, load(source, at + 2 * plane)), to, at + 2 * plane);
    store(linear_band(cz, slice, 1, row, zl - zh, load(source, at + 3 * plane)), to, at + 3 * plane);
}
