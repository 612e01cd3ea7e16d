// Steps of a light propagation volume with what blocks light between its cells (pass lpv_blocking).
//
// The first step is blocked as well, other than in the paper: light starts in the cell in front of the corners that its own surface
// blocks. Let free, it shines through the walls beside, and what a lobe has behind it, which is less than nothing, through its own:
// lit walls throw dark stains on their backs.
#include "lpv_step.h"

__kernel void lpv_propagation_blocked_step(__global const float* source, __global const float* from, __global float* to, int size,
                                           __global const float* faces, __global const int* runs,
                                           __global const LwLpvProgress* progress, int watches) {
    if (is_done(progress, watches)) return;
    const lpv_steps s = {source, size, 1, faces, runs};
    one_step(s, from, to);
}

__kernel void lpv_propagation_blocked_wave(__global const float* source, __global const float* from, __global float* first,
                                           __global float* second, int size, int steps, int parts, int atCuts,
                                           __global const float* faces, __global const int* runs,
                                           __global const LwLpvProgress* progress, int watches) {
    if (is_done(progress, watches)) return;
    const lpv_steps s = {source, size, 1, faces, runs};
    wave_of_steps(s, from, first, second, steps, parts, atCuts);
}
