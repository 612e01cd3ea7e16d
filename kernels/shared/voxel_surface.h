// How the surfaces of a voxel are packed (voxel_types.h): vectors of sums over areas in one word each.
#ifndef LW_VOXEL_SURFACE_H
#define LW_VOXEL_SURFACE_H

#include "portable.h"

// -1 .. 1 in 1023 steps of which the middle one is 0: what is no surface, and both sides of one sheet, come out as 0.
LW_FN uint pack_surface_normal(float x, float y, float z) {
    const uint i = (uint)(clamp(x, -1.0f, 1.0f) * 511.0f + 511.5f), j = (uint)(clamp(y, -1.0f, 1.0f) * 511.0f + 511.5f),
               k = (uint)(clamp(z, -1.0f, 1.0f) * 511.0f + 511.5f);
    return i | j << 10 | k << 20;
}
LW_FN float4 unpack_surface_normal(uint word) {
    return (float4)((float)(int)(word & 1023u) - 511.0f, (float)(int)(word >> 10 & 1023u) - 511.0f,
                    (float)(int)(word >> 20 & 1023u) - 511.0f, 0.0f) * (1.0f / 511.0f);
}

LW_FN uint pack_surface_albedo(float r, float g, float b) {
    const uint i = (uint)(clamp(r, 0.0f, 1.0f) * 1023.0f + 0.5f), j = (uint)(clamp(g, 0.0f, 1.0f) * 1023.0f + 0.5f),
               k = (uint)(clamp(b, 0.0f, 1.0f) * 1023.0f + 0.5f);
    return i | j << 10 | k << 20;
}
LW_FN float4 unpack_surface_albedo(uint word) {
    return (float4)((float)(word & 1023u), (float)(word >> 10 & 1023u), (float)(word >> 20 & 1023u), 0.0f) * (1.0f / 1023.0f);
}

// Of colours in 0 .. 1 relative to LwVoxelGrid::emission: an exponent e of five bits and mantissas of nine, m 2^(-e - 9). The
// largest colour is right within 1 / 512; below 2^-31 it fades to 0.
LW_FN uint pack_surface_emission(float r, float g, float b) {
    const float most = fmax(r, fmax(g, b));
    if (!(most > 0.0f)) return 0u;
    // The exponent of the float, from its bits: the power of two above `most` is 2^-e, e >= 0 as most <= 1 (of 1 itself: 511 / 512).
    int e = clamp(126 - (int)(as_uint(most) >> 23), 0, 31);
    const float scale = as_float((uint)(127 + 9 + e) << 23);
    const uint i = min((uint)(r * scale + 0.5f), 511u), j = min((uint)(g * scale + 0.5f), 511u), k = min((uint)(b * scale + 0.5f), 511u);
    return i | j << 9 | k << 18 | (uint)e << 27;
}
LW_FN float4 unpack_surface_emission(uint word) {
    const float scale = as_float((uint)(127 - 9 - (int)(word >> 27)) << 23);
    return (float4)((float)(word & 511u), (float)(word >> 9 & 511u), (float)(word >> 18 & 511u), 0.0f) * scale;
}

#endif
