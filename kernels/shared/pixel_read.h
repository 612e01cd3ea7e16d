// Reading a host's image in any format as LW_WIDTH lanes, in the width-generic dialect. The format is a
// run-time value: every work-item of a launch takes the same branch, and one kernel to build serves all
// formats, so that lwPrewarm needs no knowledge of what the host will hand over.
#ifndef LW_PIXEL_READ_H
#define LW_PIXEL_READ_H

#include "pixel_formats.h"
#include "srgb_table.h"
#include "wide.h"

#ifndef LW_LANES
#define LW_LANES(G) (G(0))
#endif

// Lanes x .. x + LW_WIDTH - 1 of a row; those past the `last` pixel repeat it, so that nothing is read
// beyond the host's pixels.
#define LW_LANE_BYTE(l) (row + (long)min(x + 0x##l, last) * stride)

LW_FN real lw_read_floats(__global const uchar* row, int x, int last, long stride) {
    if (stride == 4 && x + LW_WIDTH - 1 <= last) return load((__global const float*)row, x);
#define LW_READ_FLOAT(l) (*(__global const float*)LW_LANE_BYTE(l))
    return (real)LW_LANES(LW_READ_FLOAT);
}

LW_FN real lw_read_halves(__global const uchar* row, int x, int last, long stride) {
#define LW_READ_HALF(l) vload_half(0, (__global const half*)LW_LANE_BYTE(l))
    return (real)LW_LANES(LW_READ_HALF);
}

LW_FN real lw_read_bytes(__global const uchar* row, int x, int last, long stride) {
#define LW_READ_BYTE(l) ((float)*LW_LANE_BYTE(l))
    return (real)LW_LANES(LW_READ_BYTE);
}

LW_FN real lw_read_shorts(__global const uchar* row, int x, int last, long stride) {
#define LW_READ_SHORT(l) ((float)*(__global const short*)LW_LANE_BYTE(l))
    return (real)LW_LANES(LW_READ_SHORT);
}

LW_FN real lw_read_srgb(__global const uchar* row, int x, int last, long stride) {
#define LW_READ_SRGB(l) lw_srgb_table[*LW_LANE_BYTE(l)]
    return (real)LW_LANES(LW_READ_SRGB);
}

typedef struct LwTriple {
    real x, y, z;
} LwTriple;

// Unit length; zero where the code stands for "no surface". NaN stays NaN.
LW_FN LwTriple lw_unit_or_none(LwTriple n) {
    const real squared = fma_(n.x, n.x, fma_(n.y, n.y, n.z * n.z));
    const mask none = squared < LW_SHORTEST_QUANTISED_NORMAL * LW_SHORTEST_QUANTISED_NORMAL;
    const real length = select_(sqrt(squared), (real)1.0f, none);
    n.x = select_(n.x / length, (real)0.0f, none);
    n.y = select_(n.y / length, (real)0.0f, none);
    n.z = select_(n.z / length, (real)0.0f, none);
    return n;
}

// Octahedral map of the unit sphere (Cigolle et al. 2014, "A Survey of Efficient Representations for
// Independent Unit Vectors"), snorm16: value / 32767, at least -1.
LW_FN LwTriple lw_decode_octahedral(real u, real v) {
    const mask none = and_(u == (real)(LW_OCT_NO_SURFACE), v == (real)(LW_OCT_NO_SURFACE));
    u = fmax(u / 32767.0f, (real)-1.0f);
    v = fmax(v / 32767.0f, (real)-1.0f);
    LwTriple n;
    n.z = 1.0f - fabs(u) - fabs(v);
    // The lower half is folded over the diagonals of the square.
    const real fold = fmax(-n.z, (real)0.0f);
    n.x = u - copysign(fold, u);
    n.y = v - copysign(fold, v);
    const real length = sqrt(fma_(n.x, n.x, fma_(n.y, n.y, n.z * n.z)));
    n.x = select_(n.x / length, (real)0.0f, none);
    n.y = select_(n.y / length, (real)0.0f, none);
    n.z = select_(n.z / length, (real)0.0f, none);
    return n;
}

// The wanted channels of LW_WIDTH pixels from (x, y) on; channels that are not wanted are zero.
LW_FN LwTriple lw_read_pixels(__global const uchar* source, const LwPixels pixels, int role, int x, int y) {
    __global const uchar* row = source + pixels.byteOffset + y * pixels.byteRowStride;
    const long stride = pixels.bytePixelStride;
    const int last = pixels.width - 1;
    LwTriple v;
    v.x = (real)0.0f;
    v.y = (real)0.0f;
    v.z = (real)0.0f;
    if (pixels.format == LW_PIXEL_HALF4) {
        v.x = lw_read_halves(row, x, last, stride);
        v.y = lw_read_halves(row + 2, x, last, stride);
        v.z = lw_read_halves(row + 4, x, last, stride);
        if (role == LW_ROLE_NORMAL) v = lw_unit_or_none(v);
    } else if (pixels.format == LW_PIXEL_UNORM8X4) {
        v.x = lw_read_bytes(row, x, last, stride) / 255.0f;
        v.y = lw_read_bytes(row + 1, x, last, stride) / 255.0f;
        v.z = lw_read_bytes(row + 2, x, last, stride) / 255.0f;
        if (role == LW_ROLE_NORMAL) {
            v.x = 2.0f * v.x - 1.0f;
            v.y = 2.0f * v.y - 1.0f;
            v.z = 2.0f * v.z - 1.0f;
            v = lw_unit_or_none(v);
        }
    } else if (pixels.format == LW_PIXEL_UNORM8X4_SRGB) {
        v.x = lw_read_srgb(row, x, last, stride);
        v.y = lw_read_srgb(row + 1, x, last, stride);
        v.z = lw_read_srgb(row + 2, x, last, stride);
    } else if (pixels.format == LW_PIXEL_OCT16X2) {
        v = lw_decode_octahedral(lw_read_shorts(row, x, last, stride), lw_read_shorts(row + 2, x, last, stride));
    } else if (pixels.format == LW_PIXEL_UINT8) {
        v.x = select_((real)0.0f, (real)1.0f, lw_read_bytes(row, x, last, stride) > 0.0f);
    } else {  // floats, one plane after the other or side by side
        const long next = pixels.bytePlaneStride;
        v.x = lw_read_floats(row, x, last, stride);
        if (pixels.channels > 1) v.y = lw_read_floats(row + next, x, last, stride);
        if (pixels.channels > 2) v.z = lw_read_floats(row + 2 * next, x, last, stride);
    }
    return v;
}

#endif
