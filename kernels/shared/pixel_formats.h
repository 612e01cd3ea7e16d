// How a host's image lies in memory, for kernels that read or write it byte by byte, and for the host
// code that checks it. The format numbers are LWFormat's; src/inputs/image_check.cpp compares them.
#ifndef LW_PIXEL_FORMATS_H
#define LW_PIXEL_FORMATS_H

#include "portable.h"

#define LW_PIXEL_FLOAT1 1
#define LW_PIXEL_FLOAT2 2
#define LW_PIXEL_FLOAT3 3
#define LW_PIXEL_FLOAT4 4
#define LW_PIXEL_HALF4 5
#define LW_PIXEL_UNORM8X4 6
#define LW_PIXEL_UNORM8X4_SRGB 7
#define LW_PIXEL_OCT16X2 8
#define LW_PIXEL_PLANAR_FLOAT2 9
#define LW_PIXEL_PLANAR_FLOAT3 10
#define LW_PIXEL_UINT8 11

// What the channels mean, where that changes how they are decoded.
#define LW_ROLE_VALUE 0   // numbers as they stand
#define LW_ROLE_NORMAL 1  // unorm8 holds n/2 + 1/2; quantised formats are brought back to unit length

// An octahedral normal that stands for "no surface": both components at the one code that no unit
// vector is encoded to.
#define LW_OCT_NO_SURFACE (-32768)

// Decoded quantised normals shorter than this stand for "no surface": unorm8 has no exact zero (its
// nearest code decodes to a length below 0.01), and real normals come out longer than 0.99.
#define LW_SHORTEST_QUANTISED_NORMAL 0.5f

// Byte b of pixel (x, y) in plane c stands at
// byteOffset + y * byteRowStride + x * bytePixelStride + c * bytePlaneStride + b.
typedef struct LwPixels {
    lw_long byteOffset;
    lw_long bytePixelStride;
    lw_long byteRowStride;  // negative: rows run bottom-up
    lw_long bytePlaneStride;
    lw_int width, height;
    lw_int format;    // LW_PIXEL_*
    lw_int channels;  // 1, 2 or 3: how many are wanted
} LwPixels;
LW_SIZE_CHECK(LwPixels, 48);

#endif
