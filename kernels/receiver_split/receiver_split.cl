// A view's surfaces dealt out to two images by a mask, and two images of light put together again. Each is empty
// (zero normals) where the other has surfaces, so that neither a gather nor a filter that knows edges ever mixes
// them.
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels: normals where the mask is zero to `first`, elsewhere to `second`.
__kernel void receiver_split_normals(__global const float* normal, int4 normalLayout, __global const float* marks, int4 maskLayout,
                                     int width, int height, __global float* first, int4 firstLayout, __global float* second,
                                     int4 secondLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const mask baked = load(marks, maskLayout.x + y * maskLayout.y + x) != 0.0f;
    for (int c = 0; c < 3; ++c) {
        const real n = load(normal, normalLayout.x + c * normalLayout.z + y * normalLayout.y + x);
        store(select_(n, (real)0.0f, baked), first, firstLayout.x + c * firstLayout.z + y * firstLayout.y + x);
        store(select_((real)0.0f, n, baked), second, secondLayout.x + c * secondLayout.z + y * secondLayout.y + x);
    }
}

// One work-item = LW_WIDTH pixels of `planes` planes.
__kernel void receiver_split_join(__global const float* marks, int4 maskLayout, __global const float* first, int4 firstLayout,
                                  __global const float* second, int4 secondLayout, int width, int height, int planes,
                                  __global float* joined, int4 joinedLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const mask baked = load(marks, maskLayout.x + y * maskLayout.y + x) != 0.0f;
    for (int c = 0; c < planes; ++c) {
        const real a = load(first, firstLayout.x + c * firstLayout.z + y * firstLayout.y + x);
        const real b = load(second, secondLayout.x + c * secondLayout.z + y * secondLayout.y + x);
        store(select_(a, b, baked), joined, joinedLayout.x + c * joinedLayout.z + y * joinedLayout.y + x);
    }
}
