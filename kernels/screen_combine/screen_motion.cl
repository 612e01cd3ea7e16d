// The host's motion vectors at the texels of a level, in texels: that of the block's pixel which lies nearest to where the texel
// stands. (A mean over the block would lead from neither surface of an edge to where it was.)
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // pixels of the image per texel along each axis: 2, 4
#endif
#include "shared/wide.h"
#include "shared/interleave.h"
#include "shared/screen_types.h"
#include "shared/surface.h"

// One work-item = LW_WIDTH texels of one row. width, height: of the image. texels: the level's planes, position first.
__kernel void screen_combine_motion(__global const float* position, int4 positionLayout, __global const float* motion,
                                    int4 motionLayout, int width, int height, __global const float* texels, int4 texelLayout,
                                    __global float* moved, int4 movedLayout) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, hy = (int)get_global_id(1), x = hx * LW_INTERLEAVE;
    if (x >= width || hy * LW_INTERLEAVE >= height) return;
    const int at = texelLayout.x + hy * texelLayout.y + hx;
    const real px = load(texels, at), py = load(texels, at + texelLayout.z), pz = load(texels, at + 2 * texelLayout.z);
    real nearest = (real)MAXFLOAT, mx = (real)0.0f, my = (real)0.0f;
    for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const int y = hy * LW_INTERLEAVE + j;
        if (y >= height) break;
        real p[3][LW_INTERLEAVE], m[2][LW_INTERLEAVE];
        LW_UNROLL for (int a = 0; a < 3; ++a) load_dealt(p[a], position, positionLayout.x + a * positionLayout.z + y * positionLayout.y, x, width);
        LW_UNROLL for (int a = 0; a < 2; ++a) load_dealt(m[a], motion, motionLayout.x + a * motionLayout.z + y * motionLayout.y, x, width);
        LW_UNROLL for (int i = 0; i < LW_INTERLEAVE; ++i) {
            const real d2 = squared_length(p[0][i] - px, p[1][i] - py, p[2][i] - pz);
            const mask nearer = and_(d2 < nearest, (lanei_iota() + (lanei)hx) * LW_INTERLEAVE + (lanei)i < (lanei)width);
            nearest = select_(nearest, d2, nearer);
            mx = select_(mx, m[0][i], nearer);
            my = select_(my, m[1][i], nearer);
        }
    }
    const int to = movedLayout.x + hy * movedLayout.y + hx;
    store(mx * (1.0f / LW_INTERLEAVE), moved, to);
    store(my * (1.0f / LW_INTERLEAVE), moved, to + movedLayout.z);
}
