// Result planes packed into the host's own format. Only bytes of pixels are written, never the gaps
// between pixels or rows.
#include "shared/pixel_formats.h"
#include "shared/wide.h"

#if LW_WIDTH == 1
#define LW_STORE_LANES(type, v, base) *(__global type*)(base) = (v)
#define LW_STORE_HALF_LANES(v, base) vstore_half_rte((v), 0, (__global half*)(base))
#else
// Lanes past the last pixel are left out.
#define LW_STORE_LANES(type, v, base)                                        \
    do {                                                                     \
        float lanes[LW_WIDTH];                                               \
        LW_CAT(vstore, LW_WIDTH)((v), 0, lanes);                             \
        for (int l = 0; l < count; ++l)                                      \
            *(__global type*)((base) + l * stride) = lanes[l];               \
    } while (0)
#define LW_STORE_HALF_LANES(v, base)                                         \
    do {                                                                     \
        float lanes[LW_WIDTH];                                               \
        LW_CAT(vstore, LW_WIDTH)((v), 0, lanes);                             \
        for (int l = 0; l < count; ++l)                                      \
            vstore_half_rte(lanes[l], 0, (__global half*)((base) + l * stride)); \
    } while (0)
#endif

// One work-item = LW_WIDTH pixels of a row; `planes` holds pixels.channels of them. The fourth channel,
// where the format has one, is written 1. Half floats round to nearest even; beyond 65504 is infinity.
__kernel void output_pack(__global const float* planes, int4 layout, __global uchar* target,
                          const LwPixels pixels) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= pixels.width || y >= pixels.height) return;
    const int count = min(LW_WIDTH, pixels.width - x);
    const long stride = pixels.bytePixelStride;
    const int at = layout.x + y * layout.y + x;
    __global uchar* row = target + pixels.byteOffset + y * pixels.byteRowStride + x * stride;
    if (pixels.format == LW_PIXEL_HALF4) {
        for (int c = 0; c < pixels.channels; ++c)
            LW_STORE_HALF_LANES(load(planes, at + c * layout.z), row + 2 * c);
        LW_STORE_HALF_LANES((real)1.0f, row + 6);
    } else {
        for (int c = 0; c < pixels.channels; ++c) {
            __global uchar* first = row + c * pixels.bytePlaneStride;
            const real v = load(planes, at + c * layout.z);
            if (stride == 4 && count == LW_WIDTH)
                store(v, (__global float*)first, 0);
            else
                LW_STORE_LANES(float, v, first);
        }
        if (pixels.format == LW_PIXEL_FLOAT4) LW_STORE_LANES(float, (real)1.0f, row + 12);
    }
}
