// Result planes packed into the host's own format. Only bytes of pixels are written, never the gaps
// between pixels or rows.
#include "shared/pixel_formats.h"
#include "shared/wide.h"

// Lanes of v at `first`, `stride` bytes apart; only `count` of them.
LW_FN void lw_scatter_floats(real v, __global uchar* first, long stride, int count) {
    if (stride == 4 && count == LW_WIDTH) {
        store(v, (__global float*)first, 0);
        return;
    }
#if LW_WIDTH == 1
    *(__global float*)first = v;
#else
    if (count == LW_WIDTH) {
#define LW_PUT_LANE(l) *(__global float*)(first + 0x##l * stride) = v.s##l;
        LW_EACH_LANE(LW_PUT_LANE)
        return;
    }
    float lanes[LW_WIDTH];
    store(v, lanes, 0);
    for (int l = 0; l < count; ++l) *(__global float*)(first + l * stride) = lanes[l];
#endif
}

// The same, rounded to half.
LW_FN void lw_scatter_halves(real v, __global uchar* first, long stride, int count) {
#if LW_WIDTH == 1
    (void)stride;
    (void)count;
    vstore_half_rte(v, 0, (__global half*)first);
#else
    ushort lanes[LW_WIDTH];
    LW_CAT(LW_CAT(vstore_half, LW_WIDTH), _rte)(v, 0, (half*)lanes);
    for (int l = 0; l < count; ++l) *(__global ushort*)(first + l * stride) = lanes[l];
#endif
}

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
            lw_scatter_halves(load(planes, at + c * layout.z), row + 2 * c, stride, count);
        lw_scatter_halves((real)1.0f, row + 6, stride, count);
    } else {
        for (int c = 0; c < pixels.channels; ++c)
            lw_scatter_floats(load(planes, at + c * layout.z), row + c * pixels.bytePlaneStride, stride, count);
        if (pixels.format == LW_PIXEL_FLOAT4) lw_scatter_floats((real)1.0f, row + 12, stride, count);
    }
}
