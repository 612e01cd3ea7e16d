// A host's images as planes of float32, the form every other kernel reads. Rows are written up to the
// next multiple of 16 pixels; the padding repeats the last pixel.
#include "shared/pixel_read.h"
#include "shared/surface.h"
#include "shared/unproject_types.h"
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

LW_FN real lw_linear(float4 c, real i, real j) { return fma_(c.x, i, fma_(c.y, j, c.w)); }

// One work-item = LW_WIDTH pixels of a row. World positions from depth, and the normals beside them: a
// pixel whose depth does not unproject to a point in front of the eye and within reach has no surface, so its
// normal becomes zero, and its position zero rather than garbage.
__kernel void gbuffer_input_unproject(__global const uchar* depthSource, const LwPixels depthPixels,
                                      __global const uchar* normalSource, const LwPixels normalPixels,
                                      const LwUnprojection u, __global float* position,
                                      int4 positionLayout, __global float* normal, int4 normalLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= ((depthPixels.width + 15) & ~15) || y >= depthPixels.height) return;
    const real depth = lw_read_pixels(depthSource, depthPixels, LW_ROLE_VALUE, x, y).x;
    const real i = lane_iota() + ((float)x + 0.5f), j = (real)((float)y + 0.5f);

    LwTriple p;
    p.x = lw_linear(u.x, i, j);
    p.y = lw_linear(u.y, i, j);
    p.z = lw_linear(u.z, i, j);
    mask valid = isfinite_(depth);
    if (u.mode == LW_UNPROJECT_HOMOGENEOUS) {
        const real high = fma_(u.w.x, i, fma_(u.w.y, j, fma_(u.w.z, depth, u.w.w)));
        const real w = high + fma_(u.wRest.z, depth, lw_linear(u.wRest, i, j));
        valid = and_(valid, w > 0.0f);
        p.x = fma_(u.x.z, depth, p.x) / w;
        p.y = fma_(u.y.z, depth, p.y) / w;
        p.z = fma_(u.z.z, depth, p.z) / w;
    } else {
        const real length = sqrt(fma_(p.x, p.x, fma_(p.y, p.y, p.z * p.z)));
        const real scale = u.mode == LW_UNPROJECT_RADIAL ? depth / length : depth;
        p.x *= scale;
        p.y *= scale;
        p.z *= scale;
    }
    if (u.positiveOnly) valid = and_(valid, depth > 0.0f);
    p.x += u.origin.x;
    p.y += u.origin.y;
    p.z += u.origin.z;
    valid = and_(valid, is_within_reach(p.x, p.y, p.z));

    const real none = (real)0.0f;
    int at = positionLayout.x + y * positionLayout.y + x;
    store(select_(none, p.x, valid), position, at);
    store(select_(none, p.y, valid), position, at + positionLayout.z);
    store(select_(none, p.z, valid), position, at + 2 * positionLayout.z);

    const LwTriple n = lw_read_pixels(normalSource, normalPixels, LW_ROLE_NORMAL, x, y);
    at = normalLayout.x + y * normalLayout.y + x;
    store(select_(none, n.x, valid), normal, at);
    store(select_(none, n.y, valid), normal, at + normalLayout.z);
    store(select_(none, n.z, valid), normal, at + 2 * normalLayout.z);
}
