// VPLs that light what views show: of several times as many candidates, drawn by flux, those are kept that bring most to
// points of the views' surfaces (resampled importance sampling: Talbot et al. 2005; of VPLs: Georgiev & Slusallek 2010).
// Nothing is asked about what lies between. docs/techniques/vpl_view_sampling.md derives it.
//
// points: six planes of LW_VIEW_POINTS floats: position xyz, unit normal xyz (0: no surface).
#include "shared/find_sum.h"
#include "shared/input_limits.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"
#include "shared/vpl_view_types.h"
#include "shared/wide.h"

// Everybody's share, in mean weights of a candidate: a VPL carries at most (1 + share) / share times as much flux as one drawn by
// flux alone. Lowered, VPLs crowd more where the view is lit from straight on, and the few of other places, which light it
// around corners, flicker; raised, it is sampling by flux.
#define LW_VIEW_SHARE 1.0f
// Squared distance up to which all VPLs bring the same, in mean squared distances of the points from their middle. Lowered, single
// points draw VPLs to the spots beside them, others with each step of the camera; raised, far and near count alike.
#define LW_VIEW_REACH 0.0625f

// One work-item = one view point: columns x rows of them of a width x height view, the first at `first`.
__kernel void vpl_view_sampling_points(__global const float* position, int4 positionLayout, __global const float* normal,
                                       int4 normalLayout, int width, int height, int columns, int rows, int first,
                                       __global float* points) {
    const int k = (int)get_global_id(0);
    if (k >= columns * rows) return;
    const int column = k % columns, row = k / columns;
    const int x = ((2 * column + 1) * width) / (2 * columns), y = ((2 * row + 1) * height) / (2 * rows);
    const int p = positionLayout.x + y * positionLayout.y + x, n = normalLayout.x + y * normalLayout.y + x;
    float v[6];
    for (int a = 0; a < 3; ++a) {
        v[a] = position[p + a * positionLayout.z];
        v[3 + a] = normal[n + a * normalLayout.z];
    }
    const float n2 = v[3] * v[3] + v[4] * v[4] + v[5] * v[5], p2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const int valid = n2 > 0.25f && n2 < 4.0f && p2 <= LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE;
    const float scale = valid ? rsqrt(n2) : 0.0f;
    for (int a = 0; a < 3; ++a) {
        points[a * LW_VIEW_POINTS + first + k] = valid ? v[a] : 0.0f;
        points[(3 + a) * LW_VIEW_POINTS + first + k] = valid ? v[3 + a] * scale : 0.0f;
    }
}

LW_FN int is_point(__global const float* points, int k) {
    return points[3 * LW_VIEW_POINTS + k] != 0.0f || points[4 * LW_VIEW_POINTS + k] != 0.0f ||
           points[5 * LW_VIEW_POINTS + k] != 0.0f;
}

// One work-item. Brings the points to a frame of their own, so that no unit of length matters: their mean is its origin, the
// root of their mean squared distance from it the unit. frame: origin xyz, 1 / unit (0 where all points are one). Places
// from `count` on become none.
__kernel void vpl_view_sampling_frame(__global float* points, int count, __global float* frame) {
    if (get_global_id(0) != 0) return;
    float sum[3] = {0.0f, 0.0f, 0.0f}, number = 0.0f, squares = 0.0f;
    for (int k = 0; k < count; ++k)
        if (is_point(points, k)) {
            for (int a = 0; a < 3; ++a) sum[a] += points[a * LW_VIEW_POINTS + k];
            number += 1.0f;
        }
    for (int a = 0; a < 3; ++a) frame[a] = number > 0.0f ? sum[a] / number : 0.0f;
    for (int k = 0; k < count; ++k)
        for (int a = 0; a < 3 && is_point(points, k); ++a) {
            const float d = points[a * LW_VIEW_POINTS + k] - frame[a];
            squares += d * d;
        }
    const float spread = number > 0.0f ? squares / number : 0.0f;
    frame[3] = spread > 0.0f ? 1.0f / sqrt(spread) : 0.0f;
    for (int k = 0; k < LW_VIEW_POINTS; ++k) {
        const int valid = k < count && is_point(points, k);
        for (int a = 0; a < 3; ++a) {
            const int place = a * LW_VIEW_POINTS + k;
            points[place] = valid ? (points[place] - frame[a]) * frame[3] : 0.0f;
            if (!valid) points[place + 3 * LW_VIEW_POINTS] = 0.0f;
        }
    }
}

// One work-item = LW_WIDTH candidates: what each brings the points, sum of cos+ cos+ / max(d^2, reach).
__kernel void vpl_view_sampling_weigh(__global const float* points, __global const float* frame,
                                      __global const float* candidates, int candidateCount, __global float* weights) {
    const int k = lw_list_index() * LW_WIDTH;
    if (k >= candidateCount) return;
    const lanei i = 12 * min(lanei_iota() + k, (lanei)(candidateCount - 1));
    const float scale = frame[3];
    const real x = (gather(candidates, i) - frame[0]) * scale, y = (gather(candidates, i + 1) - frame[1]) * scale,
               z = (gather(candidates, i + 2) - frame[2]) * scale;
    const real nx = gather(candidates, i + 4), ny = gather(candidates, i + 5), nz = gather(candidates, i + 6);
    const real zero = 0.0f, one = 1.0f;
    real sum = 0.0f;
    __global const float* p = points;
    for (int j = 0; j < LW_VIEW_POINTS; ++j, ++p) {
        const real dx = p[0] - x, dy = p[LW_VIEW_POINTS] - y, dz = p[2 * LW_VIEW_POINTS] - z;
        const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
        const real from = fmax(fma_(nx, dx, fma_(ny, dy, nz * dz)), zero);
        const float mx = p[3 * LW_VIEW_POINTS], my = p[4 * LW_VIEW_POINTS], mz = p[5 * LW_VIEW_POINTS];
        const real to = fmax(-fma_(mx, dx, fma_(my, dy, mz * dz)), zero);
        const real whole = d2 * fmax(d2, (real)(LW_VIEW_REACH));
        // Where the VPL is the point, and where it is so far off that the product leaves float's range: nothing.
        const mask apart = and_(whole > 0.0f, isfinite_(whole));
        sum += select_(zero, from * to / select_(one, whole, apart), apart);
    }
    store(sum, weights, k);
}

LW_FN int is_lit(lw_vpl vpl) { return vpl.flux.x > 0.0f || vpl.flux.y > 0.0f || vpl.flux.z > 0.0f; }

// One work-item: the candidates' weights become their inclusive sums, everybody's share among them. Where nothing brings the
// points anything, all are alike.
__kernel void vpl_view_sampling_total(__global const lw_vpl* candidates, int candidateCount, __global float* weights) {
    if (get_global_id(0) != 0) return;
    float all = 0.0f, lit = 0.0f;
    for (int k = 0; k < candidateCount; ++k)
        if (is_lit(candidates[k])) {
            all += weights[k];
            lit += 1.0f;
        }
    const float share = all > 0.0f ? LW_VIEW_SHARE * all / lit : 1.0f;
    float sum = 0.0f;
    for (int k = 0; k < candidateCount; ++k) {
        if (is_lit(candidates[k])) sum += weights[k] + share;
        weights[k] = sum;
    }
}

// One work-item = one slot of the list: systematic resampling, in the candidates' order, whose strata it keeps. What a
// candidate is chosen by is its step in the sums, rounded as it is, so that the light's mean is exact.
__kernel void vpl_view_sampling_pick(__global const lw_vpl* candidates, int candidateCount, __global const float* sums,
                                     int sampleCount, float shift, __global const lw_vpl* authored, lw_subset_order order,
                                     __global lw_vpl* vpls) {
    const int slot = lw_list_index();
    if (slot >= order.subsets * order.capacity) return;
    const int k = lw_subset_index(order, slot);
    if (k < 0) { vpls[slot] = no_vpl(); return; }
    if (k >= sampleCount) { vpls[slot] = bounded(authored[k - sampleCount]); return; }
    const float total = sums[candidateCount - 1];
    if (!(total > 0.0f)) { vpls[slot] = no_vpl(); return; }
    const int c = find_sum(sums, candidateCount, ((float)k + shift) / (float)sampleCount * total);
    const float step = sums[c] - (c > 0 ? sums[c - 1] : 0.0f);
    const float factor = total / ((float)sampleCount * step);
    lw_vpl vpl = candidates[c];
    vpl.positionArea.w *= factor;
    vpl.flux = (float4)(vpl.flux.x * factor, vpl.flux.y * factor, vpl.flux.z * factor, 0.0f);
    vpls[slot] = bounded(vpl);
}
