// Screen-space compensation of what the VPLs' bounded geometry term takes from near light (Kollig and Keller 2004; on the
// screen: Novak, Engelhardt and Dachsbacher 2011). The senders are the pixels' own surfaces with their direct radiance. A
// sample that stands for an area a of a surface whose VPLs have the area A sends
//   L a c c_p (1 / (d^2 + k a/pi) - 1 / (d^2 + k A/pi)),  k = (1 + 3 c_p^2) / 4,
// what a VPL as small as the sample lights beyond those that are there: bounded itself, 0 where a >= A.
// docs/techniques/ssvp_compensation.md derives it. Nothing asks for visibility between pixel and sample.
#ifndef LW_INTERLEAVE
#define LW_INTERLEAVE 4  // 1, 2, 4, 8
#endif
#include "shared/compensation_types.h"
#include "shared/edge_weight.h"
#include "shared/interleave.h"
#include "shared/subset_order.h"
#include "shared/surface.h"
#include "shared/vpl_types.h"

// Cosine between ray and surface below which a pixel's area grows no more. Lower: single pixels on silhouettes stand for
// areas beyond what their neighbours leave room for. Higher: floors seen flatly send too little.
#define LW_FLATTEST_COSINE 0.05f

// One work-item: scale[0] = mean flux (mean of the channels) of the VPLs drawn, scale[1] = mean area, scale[2] = their
// number. `drawn`: indices below it were drawn from texels; the host's own come after them. In slots' order: same bits.
__kernel void bounding_compensation_scale(__global const lw_vpl* vpls, lw_subset_order order, int drawn, __global float* scale) {
    if (get_global_id(0) != 0) return;
    float flux = 0.0f, area = 0.0f, count = 0.0f;
    for (int slot = 0; slot < order.subsets * order.capacity; ++slot) {
        const int k = lw_subset_index(order, slot);
        if (k < 0 || k >= drawn) continue;
        const float4 phi = vpls[slot].flux;
        const float sent = (phi.x + phi.y + phi.z) * (1.0f / 3.0f);
        if (!(sent > 0.0f)) continue;
        flux += sent;
        area += vpls[slot].positionArea.w;
        count += 1.0f;
    }
    scale[0] = count > 0.0f ? flux / count : 0.0f;
    scale[1] = count > 0.0f ? area / count : 0.0f;
    scale[2] = count;
    scale[3] = 0.0f;
}

// One work-item = LW_WIDTH half-resolution pixels: the mean radiance of each block's pixels on the chosen surface.
__kernel void bounding_compensation_halve(__global const float* position, int4 positionLayout, __global const float* normal,
                                          int4 normalLayout, __global const float* radiance, int4 radianceLayout, int width,
                                          int height, __global const float* halfPosition, int4 halfPositionLayout,
                                          __global const float* halfNormal, int4 halfNormalLayout,
                                          __global float* halfRadiance, int4 halfRadianceLayout) {
    const int hx = (int)get_global_id(0) * LW_WIDTH, hy = (int)get_global_id(1), x = 2 * hx;
    if (hx >= (width + 1) / 2 || hy >= (height + 1) / 2) return;
    const int rowEnd = (width + 15) & ~15;
    const lw_surface s = load_surface(halfPosition, halfPositionLayout, halfNormal, halfNormalLayout, hx, hy);
    const lw_edges edges = edges_of(s, (real)1.0f);
    const lanei column = lanei_iota() * 2 + (lanei)x;
    const real zero = (real)0.0f;
    real sum[3] = {zero, zero, zero}, weight = zero;
    for (int j = 0; j < 2; ++j) {
        const int y = 2 * hy + j;
        if (y >= height) break;
        real v[2][9];
        for (int a = 0; a < 9; ++a) {
            __global const float* const image = a < 3 ? position : a < 6 ? normal : radiance;
            const int4 layout = a < 3 ? positionLayout : a < 6 ? normalLayout : radianceLayout;
            const int at = layout.x + (a % 3) * layout.z + y * layout.y + x;
            const real low = load(image, at), high = x + LW_WIDTH < rowEnd ? load(image, at + LW_WIDTH) : zero;
            v[0][a] = even_(low, high);
            v[1][a] = odd_(low, high);
        }
        for (int i = 0; i < 2; ++i) {
            const lw_surface q = make_surface(v[i][0], v[i][1], v[i][2], v[i][3], v[i][4], v[i][5]);
            const real w = edge_weight(edges, q.px, q.py, q.pz, q.nx, q.ny, q.nz);
            const mask on = and_(and_(q.valid, s.valid), and_(w > 0.0f, column + (lanei)i < (lanei)width));
            for (int c = 0; c < 3; ++c) sum[c] += select_(zero, v[i][6 + c], on);
            weight += ones_(on);
        }
    }
    const real scale = select_(zero, 1.0f / weight, weight > 0.0f);
    const int out = halfRadianceLayout.x + hy * halfRadianceLayout.y + hx;
    for (int c = 0; c < 3; ++c) store(sum[c] * scale, halfRadiance, out + c * halfRadianceLayout.z);
}

// Area of the surfaces behind pixels / 4 pi, and of the pixels' cross-sections there.
LW_FN real pixel_area(lw_pixel_area camera, lw_surface s, real* across) {
    const float quarter = 0.25f * M_1_PI_F;
    const real vx = s.px - camera.eye.x, vy = s.py - camera.eye.y, vz = s.pz - camera.eye.z;
    const real z = fabs(fma_(vx, camera.axis.x, fma_(vy, camera.axis.y, vz * camera.axis.z)));
    if (camera.axis.w == 0.0f) {
        const real facing = fabs(fma_(s.nx, camera.axis.x, fma_(s.ny, camera.axis.y, s.nz * camera.axis.z)));
        *across = (real)(camera.eye.w);
        return quarter * camera.eye.w / fmax(facing, (real)LW_FLATTEST_COSINE);
    }
    // cos(alpha) / cos(beta) = z / |v.n|
    const real facing = fabs(fma_(vx, s.nx, fma_(vy, s.ny, vz * s.nz)));
    const real flattest = LW_FLATTEST_COSINE * sqrt(squared_length(vx, vy, vz));
    *across = camera.eye.w * z * z;
    return quarter * *across * z / fmax(fmax(facing, flattest), (real)FLT_MIN);
}

// What a channel sends: garbage sends nothing.
LW_FN real sent(real radiance, mask valid) {
    return select_((real)0.0f, radiance, and_(valid, and_(radiance > 0.0f, radiance <= LW_LARGEST_IRRADIANCE)));
}

// One work-item = LW_WIDTH columns of all runs of one row, borders included. scale: as _scale leaves it. uniformArea: every
// VPL stands for the mean area; otherwise, drawn by flux, for the mean flux over the radiosity of its place. mostPixels: the
// square of the samples' largest distance. counts[3] grows by the senders whose VPLs' discs reach farther.
__kernel void bounding_compensation_senders(__global const float* position, int4 positionLayout,
                                            __global const float* normal, int4 normalLayout,
                                            __global const float* radiance, int4 radianceLayout, int width,
                                            lw_pixel_area camera, __global const float* scale, int uniformArea,
                                            float mostPixels, lw_sender_layout layout, __global float* senders,
                                            __global int* counts) {
    const int at = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (at >= layout.run || y >= layout.height) return;
    const int x = (at - LW_SENDER_BORDER) * LW_INTERLEAVE;
    const real zero = (real)0.0f;
    real v[9][LW_INTERLEAVE];
    for (int a = 0; a < 9; ++a) {
        __global const float* const image = a < 3 ? position : a < 6 ? normal : radiance;
        const int4 from = a < 3 ? positionLayout : a < 6 ? normalLayout : radianceLayout;
        if (x >= 0 && x < width) load_dealt(v[a], image, from.x + (a % 3) * from.z + y * from.y, x, width);
        else LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) v[a][j] = zero;
    }
    int capped = 0;
    for (int j = 0; j < LW_INTERLEAVE; ++j) {
        const lw_surface s = make_surface(v[0][j], v[1][j], v[2][j], v[3][j], v[4][j], v[5][j]);
        const real r = sent(v[6][j], s.valid), g = sent(v[7][j], s.valid), b = sent(v[8][j], s.valid);
        const real mean = (r + g + b) * (1.0f / 3.0f);
        const mask lit = mean > 0.0f;
        real across;
        const real area = pixel_area(camera, s, &across);
        const real byFlux = scale[0] * (0.25f * M_1_PI_F * M_1_PI_F) / fmax(mean, (real)FLT_MIN);
        real vpl = uniformArea ? (real)(scale[1] * (0.25f * M_1_PI_F)) : byFlux;
        vpl = select_(zero, fmin(vpl, (real)(LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE)), lit);
        const real values[LW_COMPENSATION_PLANES] = {s.px, s.py, s.pz, s.nx, s.ny, s.nz, r, g, b,
                                               select_(zero, area, lit), vpl};
        for (int a = 0; a < LW_COMPENSATION_PLANES; ++a) store(values[a], senders, lw_sender_run(layout, a, y, j) + at);
        const mask far = and_(lit, 4.0f * vpl > mostPixels * across);
        if (any_(far)) capped += count_(far);
    }
    if (capped) atomic_add(counts + 3, capped);
}

// Where the samples of one vector of receivers lie: planes of the run, `step` apart, from `at` on.
LW_FN void add_sample(rgb* e, lw_surface away, __global const float* senders, int at, int step, float cell) {
    const real dx = away.px - load(senders, at), dy = away.py - load(senders, at + step);
    const real dz = away.pz - load(senders, at + 2 * step);
    const real d2 = squared_length(dx, dy, dz);
    const real c = fmax(fma_(dx, away.nx, fma_(dy, away.ny, dz * away.nz)), (real)0.0f);
    const real nx = load(senders, at + 3 * step), ny = load(senders, at + 4 * step), nz = load(senders, at + 5 * step);
    const real cp = fmax(fma_(dx, nx, fma_(dy, ny, dz * nz)), (real)0.0f);
    const real area = cell * load(senders, at + LW_SENDER_PIXEL * step), vpl = load(senders, at + LW_SENDER_VPL * step);
    const real q = fma_(3.0f * cp, cp, d2), d4 = fma_(d2, d2, (real)1e-37f);
    // The difference of the two terms over a common denominator: as a difference it would cancel far away. One quotient
    // after the other: the product of the denominators, d^8, leaves a float's range.
    const real share = q * fmax(vpl - area, (real)0.0f) / fma_(q, vpl, d4);
    const real w = c * cp * area * share / fma_(q, area, d4);
    e->r = fma_(w, load(senders, at + LW_SENDER_RADIANCE * step), e->r);
    e->g = fma_(w, load(senders, at + (LW_SENDER_RADIANCE + 1) * step), e->g);
    e->b = fma_(w, load(senders, at + (LW_SENDER_RADIANCE + 2) * step), e->b);
}

// One work-item = LW_WIDTH * LW_INTERLEAVE adjacent pixels of one row. samples: `perSubset` for each of the interleave's
// subsets. irradiance: 3 planes, to which the light is added, or, if `alone`, which it replaces. counts[2] grows by
// the pixels that are brought down to LW_LARGEST_IRRADIANCE by what is added.
__kernel void bounding_compensation_gather(__global const float* position, int4 positionLayout,
                                           __global const float* normal, int4 normalLayout, int width, int height,
                                           __global const float* senders, lw_sender_layout layout,
                                           __global const lw_near_sample* samples, int perSubset, int alone,
                                           __global float* irradiance, int4 irradianceLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH * LW_INTERLEAVE, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const int positionRow = positionLayout.x + y * positionLayout.y, normalRow = normalLayout.x + y * normalLayout.y;
    const int irradianceRow = irradianceLayout.x + y * irradianceLayout.y;
    const int step = layout.run, last = layout.run - LW_SENDER_BORDER;
    const real zero = (real)0.0f, most = (real)LW_LARGEST_IRRADIANCE;
    real p[3][LW_INTERLEAVE], n[3][LW_INTERLEAVE], e[3][LW_INTERLEAVE];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        load_dealt(p[a], position, positionRow + a * positionLayout.z, x, width);
        load_dealt(n[a], normal, normalRow + a * normalLayout.z, x, width);
        if (!alone) load_dealt(e[a], irradiance, irradianceRow + a * irradianceLayout.z, x, width);
        else LW_UNROLL for (int j = 0; j < LW_INTERLEAVE; ++j) e[a][j] = zero;
    }
    int saturatedHere = 0;
    for (int j = 0; j < LW_INTERLEAVE; ++j) {  // not unrolled: seconds of compilation
        lw_surface away = make_surface(p[0][j], p[1][j], p[2][j], n[0][j], n[1][j], n[2][j]);
        if (!any_(away.valid)) continue;
        away.nx = -away.nx;
        away.ny = -away.ny;
        away.nz = -away.nz;
        rgb sum = {zero, zero, zero};
        __global const lw_near_sample* sample = samples + ((y & (LW_INTERLEAVE - 1)) * LW_INTERLEAVE + j) * perSubset;
        for (int k = 0; k < perSubset; ++k) {
            const int row = y + sample[k].y, column = x + j + sample[k].x;
            if (row < 0 || row >= height) continue;
            // Arithmetic: columns left of the image are negative.
            const int residue = column & (LW_INTERLEAVE - 1), run = (column - residue) / LW_INTERLEAVE + LW_SENDER_BORDER;
            add_sample(&sum, away, senders, lw_sender_run(layout, 0, row, residue) + clamp(run, 0, last), step,
                       sample[k].cell);
        }
        const real scale = (real)(4.0f * M_PI_F * LW_INTERLEAVE * LW_INTERLEAVE);
        const real r = fma_(sum.r, scale, e[0][j]), g = fma_(sum.g, scale, e[1][j]), b = fma_(sum.b, scale, e[2][j]);
        const mask saturated = and_(and_(away.valid, fmax(r, fmax(g, b)) > most), fmax(e[0][j], fmax(e[1][j], e[2][j])) < most);
        e[0][j] = select_(zero, fmin(r, most), away.valid);
        e[1][j] = select_(zero, fmin(g, most), away.valid);
        e[2][j] = select_(zero, fmin(b, most), away.valid);
        if (any_(saturated)) saturatedHere += count_(saturated);
    }
    LW_UNROLL for (int a = 0; a < 3; ++a)
        store_dealt(e[a], irradiance, irradianceRow + a * irradianceLayout.z, x, width);
    if (saturatedHere && !alone) atomic_add(counts + 2, saturatedHere);
}
