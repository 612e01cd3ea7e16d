// Irradiance of an evenly bright sky that nothing hides: pi * L on every surface (W/m^2).
#include "shared/wide.h"
#include "shared/surface.h"

// One work-item = LW_WIDTH pixels. Position and normal: three planes each; irradiance: three planes.
__kernel void ambient_sky_fill(__global const float* position, int4 positionLayout,
                               __global const float* normal, int4 normalLayout, int width, int height,
                               float4 radiance, __global float* irradiance, int4 irradianceLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    // A layout is: first element, row stride, plane stride, 0; all in floats.
    const int p = positionLayout.x + y * positionLayout.y + x, pp = positionLayout.z;
    const int n = normalLayout.x + y * normalLayout.y + x, np = normalLayout.z;
    const lw_surface s =
        make_surface(load(position, p), load(position, p + pp), load(position, p + 2 * pp),
                     load(normal, n), load(normal, n + np), load(normal, n + 2 * np));
    const real visible = ones_(s.valid) * M_PI_F;
    const int e = irradianceLayout.x + y * irradianceLayout.y + x, ep = irradianceLayout.z;
    store(visible * radiance.x, irradiance, e);
    store(visible * radiance.y, irradiance, e + ep);
    store(visible * radiance.z, irradiance, e + 2 * ep);
}
