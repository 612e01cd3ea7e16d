// Small kernels for the tests of the executor, the program cache and the device.
#include "shared/wide.h"

// One work-item = one value; surplus items stay idle.
__kernel void add_one(__global int* values, int count) {
    const int i = (int)get_global_id(0);
    if (i < count) values[i] += 1;
}

// One work-item = one value: to = 2 * from + 1, so that the order of launches shows.
__kernel void twice_and_one(__global const uint* from, __global uint* to) {
    const int i = (int)get_global_id(0);
    to[i] = 2u * from[i] + 1u;
}

// One work-item = LW_WIDTH pixels. Arguments of every kind that the executor passes.
__kernel void all_kinds(__global const float* from, int4 fromLayout, __global float* to, int4 toLayout, float scale,
                        int offset, uint shift, float4 quad) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    for (int plane = 0; plane < 2; ++plane) {
        const int in = fromLayout.x + y * fromLayout.y + plane * fromLayout.z + x;
        const int out = toLayout.x + y * toLayout.y + plane * toLayout.z + x;
        store(scale * load(from, in) + (float)offset + (float)shift + quad.w, to, out);
    }
}

// One work-item = one of a 2D grid; counts how often each cell was visited.
__kernel void visit(__global int* cells, int width, int height) {
    const int x = (int)get_global_id(0), y = (int)get_global_id(1);
    if (x < width && y < height) cells[y * width + x] += 1;
}
