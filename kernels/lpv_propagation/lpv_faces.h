// The step of cells whose light passes what blocks about their faces: no longer one matrix for a neighbour's five far faces, which
// are gathered one by one, each times what is let through on the way to it (pass lpv_blocking). Of a neighbour along axis e,
// with w the solid angles over pi and U = w_side Y1 c_u / sqrt(5):
//   front   F = T_0 w_front (Y0 c0 +- Y1 c_e)                        adds  F (LOBE0 + LOBE1 +-e)
//   side    S = T_u+ (A + U),  A = w_side (Y0 c0 +- 2 Y1 c_e / sqrt(5))    adds  S (LOBE0 + LOBE1 u); -u alike with A - U
// and with every T 1 that is the free step's matrix. Light that goes down takes the ways of light that goes up backwards: its
// way to +u is T_u-.
#ifndef LW_LPV_FACES_H
#define LW_LPV_FACES_H

#define LPV_LOBE0 0.8862269255f
#define LPV_LOBE1 1.0233267079f
#define LPV_FRONT0 0.0359775578f  // w_front Y0
#define LPV_FRONT1 0.0623149580f  // w_front Y1
#define LPV_SIDE0 0.0380214092f   // w_side Y0
#define LPV_SIDE1 0.0589025138f   // w_side Y1 2 / sqrt(5)
#define LPV_SIDE_U 0.0294512569f  // w_side Y1 1 / sqrt(5)

// From the neighbour `offset` floats away along e, up (sign 1) or down (-1): flux over pi in all, and net along e, u and v. way:
// the face's first plane.
LW_FN void add_neighbour(real* all, real* alongE, real* alongU, real* alongV, __global const float* c0, __global const float* ce,
                         __global const float* cu, __global const float* cv, int offset, float sign, __global const float* way,
                         int plane) {
    const real s0 = load_whole(c0 + offset), se = load_whole(ce + offset);
    const real su = load_whole(cu + offset), sv = load_whole(cv + offset);
    const int plus = sign > 0.0f ? plane : 2 * plane, minus = 3 * plane - plus;
    const real front = load_whole(way) * fma_(sign * LPV_FRONT1, se, LPV_FRONT0 * s0);
    const real side = fma_(sign * LPV_SIDE1, se, LPV_SIDE0 * s0);
    const real uPlus = load_whole(way + plus) * fma_(LPV_SIDE_U, su, side);
    const real uMinus = load_whole(way + minus) * fma_(-LPV_SIDE_U, su, side);
    const real vPlus = load_whole(way + 2 * plane + plus) * fma_(LPV_SIDE_U, sv, side);
    const real vMinus = load_whole(way + 2 * plane + minus) * fma_(-LPV_SIDE_U, sv, side);
    *all += front + ((uPlus + uMinus) + (vPlus + vMinus));
    *alongE += sign * front;
    *alongU += uPlus - uMinus;
    *alongV += vPlus - vMinus;
}

// LW_WIDTH cells as free_cells takes them; faces: at the first of them.
LW_FN void blocked_cells(__global const float* source, __global const float* from, __global float* to, int at, lpv_strides d,
                         __global const float* faces) {
    __global const float* c0 = from + at;
    __global const float* cx = c0 + d.plane;
    __global const float* cy = cx + d.plane;
    __global const float* cz = cy + d.plane;
    __global const float* fy = faces + LW_LPV_WAYS * d.plane;
    __global const float* fz = fy + LW_LPV_WAYS * d.plane;
    real all = (real)(0.0f), x = all, y = all, z = all;
    add_neighbour(&all, &x, &y, &z, c0, cx, cy, cz, -1, 1.0f, faces, d.plane);
    add_neighbour(&all, &x, &y, &z, c0, cx, cy, cz, 1, -1.0f, faces + 1, d.plane);
    add_neighbour(&all, &y, &x, &z, c0, cy, cx, cz, -d.row, 1.0f, fy, d.plane);
    add_neighbour(&all, &y, &x, &z, c0, cy, cx, cz, d.row, -1.0f, fy + d.row, d.plane);
    add_neighbour(&all, &z, &x, &y, c0, cz, cx, cy, -d.slice, 1.0f, fz, d.plane);
    add_neighbour(&all, &z, &x, &y, c0, cz, cx, cy, d.slice, -1.0f, fz + d.slice, d.plane);
    store(fma_(LPV_LOBE0, all, load_whole(source + at)), to, at);
    at += d.plane;
    store(fma_(LPV_LOBE1, x, load_whole(source + at)), to, at);
    at += d.plane;
    store(fma_(LPV_LOBE1, y, load_whole(source + at)), to, at);
    at += d.plane;
    store(fma_(LPV_LOBE1, z, load_whole(source + at)), to, at);
}

#endif
