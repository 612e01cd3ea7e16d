// A host's images as planes of float32, the form every other kernel reads. Rows are written up to the
// next multiple of 16 pixels; the padding repeats the last pixel.
#include "shared/pixel_read.h"
#include "shared/unproject.h"
#include "shared/wide.h"

// One work-item = LW_WIDTH pixels of a row. `source` holds the host's pixels; `out` takes
// pixels.channels planes.
__kernel void gbuffer_input_unpack(__global const uchar* source, const LwPixels pixels, int role,
                                   __global float* out, int4 layout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= ((pixels.width + 15) & ~15) || y >= pixels.height) return;
    const LwTriple v = lw_read_pixels(source, pixels, role, x, y);
    const int at = layout.x + y * layout.y + x;
    store(v.x, out, at);
    if (pixels.channels > 1) store(v.y, out, at + layout.z);
    if (pixels.channels > 2) store(v.z, out, at + 2 * layout.z);
}

// One work-item = LW_WIDTH pixels of a row. World positions from depth, and the normals beside them: a
// pixel whose depth does not unproject to a point in front of the eye and within reach has no surface, so its
// normal becomes zero as its position.
__kernel void gbuffer_input_unproject(__global const uchar* depthSource, const LwPixels depthPixels,
                                      __global const uchar* normalSource, const LwPixels normalPixels,
                                      const LwUnprojection u, __global float* position,
                                      int4 positionLayout, __global float* normal, int4 normalLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= ((depthPixels.width + 15) & ~15) || y >= depthPixels.height) return;
    const real depth = lw_read_pixels(depthSource, depthPixels, LW_ROLE_VALUE, x, y).x;
    mask valid;
    const LwTriple p = lw_unproject(u, depth, x, y, &valid);
    int at = positionLayout.x + y * positionLayout.y + x;
    store(p.x, position, at);
    store(p.y, position, at + positionLayout.z);
    store(p.z, position, at + 2 * positionLayout.z);

    const real none = (real)0.0f;
    const LwTriple n = lw_read_pixels(normalSource, normalPixels, LW_ROLE_NORMAL, x, y);
    at = normalLayout.x + y * normalLayout.y + x;
    store(select_(none, n.x, valid), normal, at);
    store(select_(none, n.y, valid), normal, at + normalLayout.z);
    store(select_(none, n.z, valid), normal, at + 2 * normalLayout.z);
}
