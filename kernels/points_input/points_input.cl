// Which of a host's points can have light at all.
#include "shared/points.h"

// One work-item = LW_WIDTH points of a row. hasValidity: whether it is wanted: 1 at points within reach, with a normal where there
// are normals, 0 elsewhere. rejected[0] grows by the others.
__kernel void points_input_check(__global const float* position, int4 positionLayout, __global const float* normal,
                                 int4 normalLayout, int hasNormals, int width, int height, int hasValidity,
                                 __global float* validity, int4 validityLayout, __global int* rejected) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_point(position, positionLayout, normal, normalLayout, hasNormals, x, y);
    if (hasValidity) store(ones_(s.valid), validity, validityLayout.x + y * validityLayout.y + x);
    const mask counted = and_(not_(s.valid), lanei_iota() + x < width);
    if (any_(counted)) atomic_add(rejected, count_(counted));
}
