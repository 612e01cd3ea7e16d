// A host's reflective shadow maps as texels that VPLs are drawn from, each read and written once.
#include "shared/pixel_read.h"
#include "shared/rsm_texel.h"
#include "shared/surface.h"
#include "shared/unproject.h"
#include "shared/wide.h"

// One work-item = one row of one map: its entry (first texel, width, map, 0) in the table of rows,
// four ints. Clears the map's counters.
__kernel void rsm_input_rows(__global int* rows, __global uint* counters, const LwRsmSpan span) {
    const int y = (int)get_global_id(0);
    if (y >= span.height) return;
    const int padded = (span.width + 15) & ~15;
    __global int* row = rows + 4 * (span.firstRow + y);
    row[0] = span.firstTexel + y * padded;
    row[1] = span.width;
    row[2] = span.index;
    row[3] = 0;
    if (y == 0)
        for (int c = 0; c < LW_RSM_COUNTERS; ++c) counters[span.index * LW_RSM_COUNTERS + c] = 0;
}

LW_FN mask lw_usable_flux(real flux) { return and_(flux >= 0.0f, flux <= LW_LARGEST_FLUX); }

// One work-item = LW_WIDTH texels of a row, from the host's pixels to LW_RSM_PLANES planes, `stride` floats apart. `place`: positions,
// or depth where fromDepth says so. Makes every value finite, the normals unit length and the padding dark, and computes the
// texel's surface area:
//   directional: A_p = A_texel / c_l;   perspective: A_p = Omega_texel * d^2 / c_l,
//   Omega_texel = (texel's area at unit distance) * cos^3(angle to the axis),
// c_l the cosine between normal and light, bounded below by LW_MIN_LIGHT_COSINE.
__kernel void rsm_input_unpack(__global const uchar* placeSource, const LwPixels placePixels, int fromDepth, const LwUnprojection u,
                               __global const uchar* normalSource, const LwPixels normalPixels, __global const uchar* fluxSource,
                               const LwPixels fluxPixels, __global float* texels, int stride, __global uint* counters,
                               const LwRsmSpan span) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    const int padded = (span.width + 15) & ~15;
    if (x >= padded || y >= span.height) return;
    __global float* at = texels + span.firstTexel + y * padded + x;
    const real none = (real)0.0f;
    const real i = lane_iota() + ((float)x + 0.5f), j = (real)((float)y + 0.5f);
    const mask inside = i < (float)span.width;

    LwTriple p = lw_read_pixels(placeSource, placePixels, LW_ROLE_VALUE, x, y);
    LwTriple n = lw_read_pixels(normalSource, normalPixels, LW_ROLE_NORMAL, x, y);
    const LwTriple flux = lw_read_pixels(fluxSource, fluxPixels, LW_ROLE_VALUE, x, y);
    if (fromDepth) {
        mask there;
        p = lw_unproject(u, p.x, x, y, &there);
        n.x = select_(none, n.x, there);
        n.y = select_(none, n.y, there);
        n.z = select_(none, n.z, there);
    }
    const real px = p.x, py = p.y, pz = p.z, r = flux.x, g = flux.y, b = flux.z;
    real nx = n.x, ny = n.y, nz = n.z;

    // What is there: nothing (zero normal), something that can't be used, or a lit surface.
    const real n2 = fma_(nx, nx, fma_(ny, ny, nz * nz));
    const mask empty = n2 == 0.0f;
    const mask usable = and_(and_(isfinite_(n2), is_within_reach(px, py, pz)),
                             and_(lw_usable_flux(r), and_(lw_usable_flux(g), lw_usable_flux(b))));
    const mask occupied = and_(inside, not_(empty));
    mask surface = and_(occupied, usable);
    const mask covered = and_(inside, rsm_covered(span, i, j));

    // Area of the surface seen through the texel.
    const real scale = select_((real)1.0f, sqrt(n2), surface);
    nx = select_(none, nx / scale, surface);
    ny = select_(none, ny / scale, surface);
    nz = select_(none, nz / scale, surface);
    real area;
    if (span.perspective) {
        const real lx = span.light.x - px, ly = span.light.y - py, lz = span.light.z - pz;
        const real d2 = fma_(lx, lx, fma_(ly, ly, lz * lz));
        const real distance = sqrt(select_((real)1.0f, d2, d2 > 0.0f));
        const real cosine = fma_(nx, lx, fma_(ny, ly, nz * lz)) / distance;
        const real ax = rsm_linear(span.rayX, i, j), ay = rsm_linear(span.rayY, i, j),
                   az = rsm_linear(span.rayZ, i, j);
        const real ray2 = fma_(ax, ax, fma_(ay, ay, az * az));  // 1 / cos^2 of the angle to the axis
        area = span.texelArea / (ray2 * sqrt(ray2)) * d2 / fmax(cosine, (real)LW_MIN_LIGHT_COSINE);
    } else {
        // The normal stands on the lit side, so the axis needs no sign.
        const real cosine = fabs(fma_(nx, span.light.x, fma_(ny, span.light.y, nz * span.light.z)));
        area = span.texelArea / fmax(cosine, (real)LW_MIN_LIGHT_COSINE);
    }

    // An eye beyond all distances, or a texel wider than float holds, leaves no area to bound the light by.
    surface = and_(surface, isfinite_(area));
    const mask rejected = and_(occupied, not_(surface));

    const mask lit = and_(surface, not_(covered));
    store_past(select_(none, px, surface), at, 0);
    store_past(select_(none, py, surface), at, stride);
    store_past(select_(none, pz, surface), at, 2 * stride);
    store_past(select_(none, nx, surface), at, 3 * stride);
    store_past(select_(none, ny, surface), at, 4 * stride);
    store_past(select_(none, nz, surface), at, 5 * stride);
    store(select_(none, r, lit), at, 6 * stride);
    store(select_(none, g, lit), at, 7 * stride);
    store(select_(none, b, lit), at, 8 * stride);
    store_past(select_(none, area, surface), at, 9 * stride);

    // Whole-number counts: the order of the additions does not show.
    counters += span.index * LW_RSM_COUNTERS;
    if (any_(rejected)) atomic_add(counters + LW_RSM_REJECTED, (uint)count_(rejected));
    if (any_(covered)) atomic_add(counters + LW_RSM_COVERED, (uint)count_(covered));
}
