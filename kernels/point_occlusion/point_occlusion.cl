// Point-sampled occlusion in screen space: points in each pixel's hemisphere, hidden where the view shows something
// nearer (SSAO, Mittring 2007; in the hemisphere since Filion and McNaughton 2008). LW_LIGHT 1: what hides them lights the
// pixel too (SSDO's one bounce, Ritschel et al. 2009). A 4 x 4 pattern of rotations, which the filter after it needs.
#ifndef LW_LIGHT
#define LW_LIGHT 1
#endif
#include "shared/point_occlusion_types.h"
#include "shared/surface.h"

typedef struct { real r, g, b, seen, hidden; } lw_occlusion;

// Rotation of the pixels x .. x + LW_WIDTH - 1: cosine and sine, two planes of 16.
LW_FN lanei pattern_index(int x, int y) { return ((lanei_iota() + (lanei)x) & (lanei)3) + (lanei)((y & 3) * 4); }

// planes of the gathered level: position (3), normal (3, unit or zero), with LW_LIGHT radiance (3), depth along the axis.
// points: float4 each: tangent, bitangent, normal in units of the radius; rotations: 16 cosines, 16 sines. gathered: as
// WeightedFilter takes it, every weight 1. One work-item = LW_WIDTH adjacent pixels.
__kernel void point_occlusion_gather(__global const float* level, int4 layout, int width, int height,
                                     __global const float4* points, __global const float* rotations, lw_point_view view,
                                     __global float* gathered, int4 gatheredLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int own = layout.x + y * layout.y + x, plane = layout.z, depthPlane = (LW_LIGHT ? 9 : 6) * plane;
    const real px = load(level, own), py = load(level, own + plane), pz = load(level, own + 2 * plane);
    const real nx = load(level, own + 3 * plane), ny = load(level, own + 4 * plane), nz = load(level, own + 5 * plane);
    const mask valid = squared_length(nx, ny, nz) > 0.25f;
    const int perspective = view.eye.w != 0.0f;
    const real ownDepth = load(level, own + depthPlane);
    const real radius = perspective ? view.range.x * fabs(ownDepth) : (real)view.range.x;
    // A frame about the normal (Duff et al. 2017), turned by the pixel's own angle.
    const real sign = select_((real)-1.0f, (real)1.0f, nz >= 0.0f), a = -1.0f / (sign + nz), b = nx * ny * a;
    const real cosine = gather(rotations, pattern_index(x, y)), sine = gather(rotations, pattern_index(x, y) + 16);
    const real ux = fma_(sign * nx * nx, a, (real)1.0f), uy = sign * b, uz = -sign * nx;
    const real wx = b, wy = fma_(ny * ny, a, sign), wz = -ny;
    const real tx = fma_(cosine, ux, sine * wx), ty = fma_(cosine, uy, sine * wy), tz = fma_(cosine, uz, sine * wz);
    const real bx = fma_(cosine, wx, -sine * ux), by = fma_(cosine, wy, -sine * uy), bz = fma_(cosine, wz, -sine * uz);

    const int count = any_(valid) ? (int)view.range.w : 0;
    const real area = radius * radius * (1.0f / fmax(view.range.w, 1.0f));  // over pi, of the disc that a point stands for
    const real zero = (real)0.0f;
    lw_occlusion sum = {zero, zero, zero, zero, zero};
    for (int i = 0; i < count; ++i) {
        const float4 q = points[i];
        const real ox = radius * fma_(tx, (real)q.x, fma_(bx, (real)q.y, nx * q.z));
        const real oy = radius * fma_(ty, (real)q.x, fma_(by, (real)q.y, ny * q.z));
        const real oz = radius * fma_(tz, (real)q.x, fma_(bz, (real)q.y, nz * q.z));
        const real ex = px + ox - view.eye.x, ey = py + oy - view.eye.y, ez = pz + oz - view.eye.z;
        const real depth = fma_(ex, (real)view.depth.x, fma_(ey, (real)view.depth.y, fma_(ez, (real)view.depth.z, (real)view.depth.w)));
        const real c = fma_(ex, (real)view.column.x, fma_(ey, (real)view.column.y, fma_(ez, (real)view.column.z, (real)view.column.w)));
        const real r = fma_(ex, (real)view.row.x, fma_(ey, (real)view.row.y, fma_(ez, (real)view.row.z, (real)view.row.w)));
        const real scale = perspective ? 1.0f / depth : (real)1.0f;
        const real column = c * scale, row = r * scale;
        mask inside = and_(and_(column >= 0.0f, column < (real)(float)width), and_(row >= 0.0f, row < (real)(float)height));
        if (perspective) inside = and_(inside, depth > 0.0f);
        const lanei at = (lanei)layout.x + selecti_((lanei)0, to_lanei(clamp(row, zero, (real)(float)(height - 1))), inside) * layout.y +
                         selecti_((lanei)0, to_lanei(clamp(column, zero, (real)(float)(width - 1))), inside);
        const real seenDepth = gather(level, at + (lanei)depthPlane);
        const real mx = gather(level, at + (lanei)(3 * plane)), my = gather(level, at + (lanei)(4 * plane)),
                   mz = gather(level, at + (lanei)(5 * plane));
        const real before = depth - seenDepth;
        mask hidden = and_(and_(inside, squared_length(mx, my, mz) > 0.25f), before > view.range.y * radius);
        if (view.range.z != 0.0f) hidden = and_(hidden, before < radius);
        sum.hidden += ones_(hidden);
#if LW_LIGHT
        const real dx = gather(level, at) - px, dy = gather(level, at + (lanei)plane) - py, dz = gather(level, at + (lanei)(2 * plane)) - pz;
        const real d2 = squared_length(dx, dy, dz), inverse = rsqrt(d2);
        const real receiver = fma_(dx, nx, fma_(dy, ny, dz * nz)) * inverse;
        const real sender = -fma_(dx, mx, fma_(dy, my, dz * mz)) * inverse;
        const mask lights = and_(and_(hidden, d2 > 0.0f), and_(receiver > 0.0f, sender > 0.0f));
        // The bounded term of conventions.md: (Phi / pi) c_p c / (d^2 + (1 + 3 c_p^2) / 4 * A / pi), Phi / pi = L A. The
        // factor pi of A stands in the filter, which turns radiance into irradiance.
        const real w = area * sender * receiver / fma_(0.25f * fma_(3.0f * sender, sender, (real)1.0f), area, d2);
        const real weight = select_(zero, w, lights);
        sum.r = fma_(weight, gather(level, at + (lanei)(6 * plane)), sum.r);
        sum.g = fma_(weight, gather(level, at + (lanei)(7 * plane)), sum.g);
        sum.b = fma_(weight, gather(level, at + (lanei)(8 * plane)), sum.b);
        sum.seen += ones_(lights);
#endif
    }
    const real share = (real)(1.0f / fmax(view.range.w, 1.0f));
    int out = gatheredLayout.x + y * gatheredLayout.y + x;
#if LW_LIGHT
    store(select_(zero, sum.r, valid), gathered, out);
    store(select_(zero, sum.g, valid), gathered, out + gatheredLayout.z);
    store(select_(zero, sum.b, valid), gathered, out + 2 * gatheredLayout.z);
    store(select_(zero, sum.seen * share, valid), gathered, out + 3 * gatheredLayout.z);
    out += 4 * gatheredLayout.z;
#endif
    store(select_(zero, fma_(-sum.hidden, share, (real)1.0f), valid), gathered, out);
    store(ones_(valid), gathered, out + gatheredLayout.z);
}
