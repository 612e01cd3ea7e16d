// A virtual point light as kernels and host share it; LWVpl of the public header has this layout.
#ifndef LW_VPL_TYPES_H
#define LW_VPL_TYPES_H

#include "portable.h"

// xyz and one scalar each, so that one VPL is three aligned 4-vectors.
typedef struct {
    lw_float4 positionArea;  // m, m^2: the area bounds the light close to the emitter
    lw_float4 normal;        // unit; w: A / 4 pi in m^2, what the gather's bounded term takes: written
                             // where the list is made
    lw_float4 flux;          // W per channel; w unused
} lw_vpl;
LW_SIZE_CHECK(lw_vpl, 48);

#endif
