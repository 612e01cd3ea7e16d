// Steps of a light propagation volume with what blocks light between its cells (pass lpv_blocking).
//
// The first step is not blocked: light starts in the cell whose face its own surface blocks. What it sends, P g, is what the later
// steps Q begin with:
//   S_n = g + (1 + Q + ... + Q^(n-1)) P g = (1 + ... + Q^(n-1)) h + Q^n g   with  h = g + (P - Q) g,
// which is the recurrence of free steps once more, S_(n+1) = h + Q S_n from S_0 = g on. Where nothing blocks, h is g to the bit.
#include "lpv_step.h"

// h: what blockers would take of the first step is put back. One work-item as of a step.
__kernel void lpv_propagation_first(__global const float* injected, __global float* to, int size, __global const float* faces,
                                    __global const int* runs) {
    const int x = (int)get_global_id(0) * LW_WIDTH, line = (int)get_global_id(1), bits = 31 - (int)clz(size);
    if (x >= size || line >= LW_LPV_COLOURS * size * size) return;
    const int y = line & (size - 1), z = line >> bits & (size - 1), cell = lpv_cell(size, x, y, z);
    const lpv_strides d = strides_of(size);
    int at = LW_LPV_BANDS * (line >> 2 * bits) * d.plane + cell;
    if (runs[(z * size + y) * (size / LW_LPV_BLOCK_RUN) + x / LW_LPV_BLOCK_RUN]) {
        blocked_cells(injected, injected, to, at, d, faces + cell, 1);
        return;
    }
    for (int band = 0; band < LW_LPV_BANDS; ++band, at += d.plane) store(load_whole(injected + at), to, at);
}

__kernel void lpv_propagation_blocked_step(__global const float* source, __global const float* from, __global float* to, int size,
                                           __global const float* faces, __global const int* runs) {
    const lpv_steps s = {source, size, 1, faces, runs};
    one_step(s, from, to);
}

__kernel void lpv_propagation_blocked_wave(__global const float* source, __global const float* from, __global float* first,
                                           __global float* second, int size, int steps, int parts, int atCuts,
                                           __global const float* faces, __global const int* runs) {
    const lpv_steps s = {source, size, 1, faces, runs};
    wave_of_steps(s, from, first, second, steps, parts, atCuts);
}
