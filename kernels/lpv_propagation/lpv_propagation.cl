// Steps of a light propagation volume that nothing blocks.
#include "lpv_step.h"

__kernel void lpv_propagation_step(__global const float* source, __global const float* from, __global float* to, int size,
                                   __global const LwLpvProgress* progress, int watches) {
    if (is_done(progress, watches)) return;
    const lpv_steps s = {source, size, 0, 0, 0};
    one_step(s, from, to);
}

__kernel void lpv_propagation_wave(__global const float* source, __global const float* from, __global float* first,
                                   __global float* second, int size, int steps, int parts, int atCuts,
                                   __global const LwLpvProgress* progress, int watches) {
    if (is_done(progress, watches)) return;
    const lpv_steps s = {source, size, 0, 0, 0};
    wave_of_steps(s, from, first, second, steps, parts, atCuts);
}
