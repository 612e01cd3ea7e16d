// VPLs that light what views show: of several times as many candidates, drawn by flux, those are kept that bring most to
// points of the views' surfaces (resampled importance sampling, Talbot et al. 2005; for VPLs Georgiev & Slusallek 2010). The
// view points are fixed places of each view's picture (Ritschel et al. 2011 weigh by the same question).
//
// points: eight planes of LW_VIEW_POINTS floats: position xyz, unit normal xyz (0: no surface), squared reach, gain.
#include "shared/find_sum.h"
#include "shared/hammersley.h"
#include "shared/surface.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"
#include "shared/vpl_view_types.h"
#include "shared/wide.h"


#ifndef LW_VIEW_ALPHA
#define LW_VIEW_ALPHA 0.25f
#endif
#ifndef LW_VIEW_FLOOR
#define LW_VIEW_FLOOR 0.1f
#endif
#ifndef LW_VIEW_RELATIVE
#define LW_VIEW_RELATIVE 1
#endif

enum { kPx, kPy, kPz, kNx, kNy, kNz, kReach, kGain };

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
    return points[kNx * LW_VIEW_POINTS + k] != 0.0f || points[kNy * LW_VIEW_POINTS + k] != 0.0f ||
           points[kNz * LW_VIEW_POINTS + k] != 0.0f;
}

// One work-item. frame: the points' mean xyz, and the inverse of their root mean squared distance from it, 0 if there is none.
__kernel void vpl_view_sampling_frame(__global const float* points, int count, __global float* frame) {
    if (get_global_id(0) != 0) return;
    float sum[3] = {0.0f, 0.0f, 0.0f}, number = 0.0f;
    for (int k = 0; k < count; ++k)
        if (is_point(points, k)) {
            for (int a = 0; a < 3; ++a) sum[a] += points[a * LW_VIEW_POINTS + k];
            number += 1.0f;
        }
    const float share = number > 0.0f ? 1.0f / number : 0.0f;
    float squares = 0.0f;
    for (int k = 0; k < count; ++k)
        if (is_point(points, k))
            for (int a = 0; a < 3; ++a) {
                const float d = points[a * LW_VIEW_POINTS + k] - sum[a] * share;
                squares += d * d;
            }
    for (int a = 0; a < 3; ++a) frame[a] = sum[a] * share;
    const float spread = squares * share;
    frame[3] = spread > 0.0f ? rsqrt(spread) : 0.0f;
}

// One work-item = one view point: in the frame of all, with its reach.
__kernel void vpl_view_sampling_place(__global const float* points, int count, __global const float* frame,
                                      __global float* placed, __global lw_vpl* list) {
    const int k = (int)get_global_id(0);
    if (k >= LW_VIEW_POINTS) return;
    const int valid = k < count && is_point(points, k);
    float at[3];
    for (int a = 0; a < 3; ++a) at[a] = valid ? points[a * LW_VIEW_POINTS + k] : 0.0f;
    float nearest = INFINITY;
    for (int j = 0; j < count && valid; ++j)
        if (j != k && is_point(points, j)) {
            float d2 = 0.0f;
            for (int a = 0; a < 3; ++a) {
                const float d = points[a * LW_VIEW_POINTS + j] - at[a];
                d2 += d * d;
            }
            nearest = fmin(nearest, d2);
        }
    for (int a = 0; a < 3; ++a) {
        placed[a * LW_VIEW_POINTS + k] = valid ? (at[a] - frame[a]) * frame[3] : 0.0f;
        placed[(3 + a) * LW_VIEW_POINTS + k] = valid ? points[(3 + a) * LW_VIEW_POINTS + k] : 0.0f;
    }
    placed[kReach * LW_VIEW_POINTS + k] = valid ? fmax(nearest * frame[3] * frame[3], LW_VIEW_FLOOR / (float)LW_VIEW_POINTS) : 1.0f;
    placed[kGain * LW_VIEW_POINTS + k] = valid ? 1.0f : 0.0f;
    lw_vpl site = no_vpl();
    if (valid) {
        site.positionArea = (float4)(at[0], at[1], at[2], 1.0f);
        site.normal = (float4)(placed[kNx * LW_VIEW_POINTS + k], placed[kNy * LW_VIEW_POINTS + k], placed[kNz * LW_VIEW_POINTS + k], 0.0f);
        site.flux = (float4)(1.0f, 1.0f, 1.0f, 0.0f);
    }
    list[k] = site;
}

// cos+ cos+ / max(d^2, reach) between candidates and a point.
LW_FN real brought(real dx, real dy, real dz, real vx, real vy, real vz, real px, real py, real pz, real reach) {
    // d: from VPL to point
    const real d2 = fma_(dx, dx, fma_(dy, dy, dz * dz));
    const real from = fmax(fma_(vx, dx, fma_(vy, dy, vz * dz)), (real)(0.0f));
    const real to = fmax(-fma_(px, dx, fma_(py, dy, pz * dz)), (real)(0.0f));
    const real whole = d2 * fmax(d2, reach);
    const mask apart = whole > 0.0f;
    return select_((real)(0.0f), from * to / select_((real)(1.0f), whole, apart), apart);
}

// One work-item = LW_WIDTH candidates, as planes in the frame of the points: position xyz, normal xyz; those beyond the list
// face nowhere.
__kernel void vpl_view_sampling_candidates(__global const float* candidates, int candidateCount, int stride,
                                           __global const float* frame, __global float* planes) {
    const int k = (int)get_global_id(0) * LW_WIDTH;
    if (k >= stride) return;
    const lanei lane = lanei_iota() + k, i = 12 * min(lane, (lanei)(candidateCount - 1));
    for (int a = 0; a < 3; ++a) {
        const real at = (gather(candidates, i + a) - frame[a]) * frame[3], normal = gather(candidates, i + 4 + a);
        store(at, planes, k + a * stride);
        store(select_((real)(0.0f), normal, lane < candidateCount), planes, k + (3 + a) * stride);
    }
}

LW_FN real brought_by(__global const float* planes, int stride, int k, __global const float* placed, int p) {
    return brought(placed[p] - load(planes, k), placed[p + LW_VIEW_POINTS] - load(planes, k + stride),
                   placed[p + 2 * LW_VIEW_POINTS] - load(planes, k + 2 * stride), load(planes, k + 3 * stride),
                   load(planes, k + 4 * stride), load(planes, k + 5 * stride), (real)(placed[p + kNx * LW_VIEW_POINTS]),
                   (real)(placed[p + kNy * LW_VIEW_POINTS]), (real)(placed[p + kNz * LW_VIEW_POINTS]),
                   (real)(placed[p + kReach * LW_VIEW_POINTS]));
}

// One work-item = LW_WIDTH of a point's LW_VIEW_PARTS sums, of every LW_VIEW_PARTS-th candidate.
__kernel void vpl_view_sampling_light(__global const float* placed, __global const float* planes, int stride,
                                      __global const int* groups, __global const float* sights, int hasSights,
                                      __global float* parts) {
    const int part = (int)get_global_id(0) * LW_WIDTH, p = (int)get_global_id(1);
    if (part >= LW_VIEW_PARTS || p >= LW_VIEW_POINTS) return;
    real sum = 0.0f;
    const int group = hasSights ? groups[p] : 0;
    if (group >= 0 && placed[p + kGain * LW_VIEW_POINTS] > 0.0f)
        for (int k = part; k < stride; k += LW_VIEW_PARTS) {
            const real light = brought_by(planes, stride, k, placed, p);
            sum += hasSights ? light * load(sights, group * stride + k) : light;
        }
    store(sum, parts, p * LW_VIEW_PARTS + part);
}

// One work-item = one point: what each counts.
__kernel void vpl_view_sampling_gain(__global const float* parts, __global float* placed) {
    const int p = (int)get_global_id(0);
    if (p >= LW_VIEW_POINTS) return;
    float sum = 0.0f;
    for (int i = 0; i < LW_VIEW_PARTS; ++i) sum += parts[p * LW_VIEW_PARTS + i];
    if (LW_VIEW_RELATIVE || !(sum > 0.0f)) placed[p + kGain * LW_VIEW_POINTS] = sum > 0.0f ? 1.0f / sum : 0.0f;
}

// One work-item = LW_WIDTH candidates.
__kernel void vpl_view_sampling_weigh(__global const float* placed, __global const float* planes, int stride,
                                      __global const int* groups, __global const float* sights, int hasSights,
                                      __global float* weights) {
    const int k = (int)get_global_id(0) * LW_WIDTH;
    if (k >= stride) return;
    real sum = 0.0f;
    for (int p = 0; p < LW_VIEW_POINTS; ++p) {
        const float gain = placed[kGain * LW_VIEW_POINTS + p];
        if (!(gain > 0.0f)) continue;
        const real light = brought_by(planes, stride, k, placed, p);
        sum = fma_(gain, hasSights ? light * load(sights, groups[p] * stride + k) : light, sum);
    }
    store(sum, weights, k);
}

// One work-item: inclusive sums of the candidates' weights, with everybody's share.
__kernel void vpl_view_sampling_total(__global const float* candidates, int candidateCount, __global const float* weights,
                                      __global float* sums) {
    if (get_global_id(0) != 0) return;
    float all = 0.0f, lit = 0.0f;
    for (int k = 0; k < candidateCount; ++k) {
        __global const float* v = candidates + 12 * k;
        if (v[8] + v[9] + v[10] > 0.0f) {
            all += weights[k];
            lit += 1.0f;
        }
    }
    const float share = lit > 0.0f && all > 0.0f ? LW_VIEW_ALPHA * all / lit : 1.0f;
    float sum = 0.0f;
    for (int k = 0; k < candidateCount; ++k) {
        __global const float* v = candidates + 12 * k;
        if (v[8] + v[9] + v[10] > 0.0f) sum += weights[k] + share;
        sums[k] = sum;
    }
}

// One work-item = one slot of the list.
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
    const float u = ((float)k + shift) / (float)sampleCount;
    const int c = find_sum(sums, candidateCount, u * total);
    const float weight = sums[c] - (c > 0 ? sums[c - 1] : 0.0f);
    const float factor = total / ((float)sampleCount * weight);
    lw_vpl vpl = candidates[c];
    vpl.positionArea.w *= factor;
    vpl.flux.xyz *= factor;
    vpls[slot] = bounded(vpl);
}
