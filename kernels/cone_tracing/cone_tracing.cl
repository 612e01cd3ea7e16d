// What technique cone_tracing makes of its passes' images.
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels: irradiance times the open share of the hemisphere.
__kernel void cone_tracing_dim(__global float* irradiance, int4 irradianceLayout, __global const float* open, int4 openLayout,
                               int width, int height) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const real share = load(open, openLayout.x + y * openLayout.y + x);
    const int at = irradianceLayout.x + y * irradianceLayout.y + x;
    for (int c = 0; c < 3; ++c) store(load(irradiance, at + c * irradianceLayout.z) * share, irradiance, at + c * irradianceLayout.z);
}
