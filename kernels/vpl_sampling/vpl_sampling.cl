// VPLs drawn from the texels of all reflective shadow maps (Dachsbacher & Stamminger 2005), by a
// Hammersley set that is warped through the distribution of reflected flux, or of texels alone.
// The RSMs stand as one table of rows: u picks the row through the rows' cumulative sums, v the texel
// within the row, so that one stratified set covers any number of maps.
//
// Sampling texel p with probability P_p divides its flux *and* its area by N * P_p.
// Planes of `texels`: position xyz, normal xyz, flux rgb, area; `planeStride` floats apart.
#include "shared/find_sum.h"
#include "shared/hammersley.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"
#include "shared/subset_order.h"

// What a texel is drawn by. The mean of the channels, not luminance: a texel that reflects only blue
// must keep a probability in proportion to what it sends.
LW_FN float texel_weight(__global const float* texels, int planeStride, int texel, int uniformWeights) {
    return uniformWeights ? 1.0f
                          : (texels[6 * planeStride + texel] + texels[7 * planeStride + texel] +
                             texels[8 * planeStride + texel]) * (1.0f / 3.0f);
}

// One work-item = one row: inclusive prefix sums of its weights, in texel order, so that the result
// does not depend on the work-groups.
__kernel void vpl_sampling_row_sums(__global const float* texels, int4 layout, __global const int4* rows,
                                    int rowCount, int uniformWeights, __global float* texelSums,
                                    __global float* rowTotals) {
    const int r = lw_list_index();
    if (r >= rowCount) return;
    const int4 row = rows[r];
    __global const float* base = texels + layout.x;
    float sum = 0.0f;
    for (int i = 0; i < row.y; ++i) {
        sum += texel_weight(base, layout.z, row.x + i, uniformWeights);
        texelSums[row.x + i] = sum;
    }
    rowTotals[r] = sum;
}

// One work-item: inclusive prefix sums over the rows.
__kernel void vpl_sampling_total(__global const float* rowTotals, int rowCount, __global float* rowSums) {
    if (get_global_id(0) != 0) return;
    float sum = 0.0f;
    for (int r = 0; r < rowCount; ++r) {
        sum += rowTotals[r];
        rowSums[r] = sum;
    }
}

LW_FN lw_vpl texel_vpl(__global const float* texels, int planeStride, int texel, float factor) {
    __global const float* p = texels + texel;
    lw_vpl vpl;
    vpl.positionArea = (float4)(p[0], p[planeStride], p[2 * planeStride], p[9 * planeStride] * factor);
    vpl.normal = (float4)(p[3 * planeStride], p[4 * planeStride], p[5 * planeStride], 0.0f);
    vpl.flux = (float4)(p[6 * planeStride] * factor, p[7 * planeStride] * factor, p[8 * planeStride] * factor, 0.0f);
    return bounded(vpl);
}

// One slot of the VPL list. Of the order's `count` VPLs the first `sampleCount` are for samples of the texels, of which
// `live` are drawn and the others empty; the rest are the host's own.
LW_FN void draw_slot(int slot, __global const float* texels, int4 layout, __global const int4* rows, int rowCount,
                     __global const float* texelSums, __global const float* rowSums, int uniformWeights, int sampleCount,
                     int live, float2 shift, __global const lw_vpl* authored, lw_subset_order order, __global lw_vpl* vpls) {
    if (slot >= order.subsets * order.capacity) return;
    const int k = lw_subset_index(order, slot);
    if (k < 0) { vpls[slot] = no_vpl(); return; }
    if (k >= sampleCount) { vpls[slot] = bounded(authored[k - sampleCount]); return; }
    const float total = rowSums[rowCount - 1];
    if (!(total > 0.0f) || k >= live) { vpls[slot] = no_vpl(); return; }

    // The middle of each stratum in u: with its start, texels at the map's edge would be favoured.
    const float u = wrap_unit(((float)k + 0.5f) / (float)live + shift.x);
    const float v = wrap_unit(radical_inverse((uint)k) + shift.y);
    const int r = find_sum(rowSums, rowCount, u * total);
    const int4 row = rows[r];
    const float rowTotal = texelSums[row.x + row.y - 1];
    const int texel = row.x + find_sum(texelSums + row.x, row.y, v * rowTotal);
    __global const float* base = texels + layout.x;
    const float probability = texel_weight(base, layout.z, texel, uniformWeights) / total;
    const lw_vpl vpl = texel_vpl(base, layout.z, texel, 1.0f / ((float)live * probability));
    // A texel with next to none of all flux (v = 0 falls on it nevertheless) would stand for an area beyond any: it
    // lights nothing, and its numbers leave float's range.
    const float largest = fmax(fmax(vpl.positionArea.w, vpl.flux.x), fmax(vpl.flux.y, vpl.flux.z));
    if (isfinite(largest)) vpls[slot] = vpl;
    else vpls[slot] = no_vpl();
}

// One work-item = one slot of the list (order.subsets * order.capacity of them). `shift`: Cranley-Patterson rotation of
// the set.
__kernel void vpl_sampling_draw(__global const float* texels, int4 layout, __global const int4* rows,
                                int rowCount, __global const float* texelSums, __global const float* rowSums,
                                int uniformWeights, int sampleCount, float2 shift,
                                __global const lw_vpl* authored, lw_subset_order order, __global lw_vpl* vpls) {
    draw_slot(lw_list_index(), texels, layout, rows, rowCount, texelSums, rowSums, uniformWeights, sampleCount, sampleCount,
              shift, authored, order, vpls);
}

// The same of so many samples as another pass has chosen.
__kernel void vpl_sampling_draw_live(__global const float* texels, int4 layout, __global const int4* rows,
                                     int rowCount, __global const float* texelSums, __global const float* rowSums,
                                     int uniformWeights, int sampleCount, float2 shift, __global const lw_vpl* authored,
                                     lw_subset_order order, __global const int* live, __global lw_vpl* vpls) {
    draw_slot(lw_list_index(), texels, layout, rows, rowCount, texelSums, rowSums, uniformWeights, sampleCount,
              clamp(live[0], 1, sampleCount), shift, authored, order, vpls);
}

// The same list when every texel is a VPL of its own, with its flux and area as they are.
__kernel void vpl_sampling_all(__global const float* texels, int4 layout, int texelCount,
                               __global const lw_vpl* authored, lw_subset_order order, __global lw_vpl* vpls) {
    const int slot = lw_list_index();
    if (slot >= order.subsets * order.capacity) return;
    const int k = lw_subset_index(order, slot);
    if (k < 0) vpls[slot] = no_vpl();
    else if (k >= texelCount) vpls[slot] = bounded(authored[k - texelCount]);
    else vpls[slot] = texel_vpl(texels + layout.x, layout.z, k, 1.0f);
}

// For debugging: the list as ten planes (position, normal, flux, area).
__kernel void vpl_sampling_planes(__global const lw_vpl* vpls, int count, __global float* planes, int planeStride) {
    const int i = lw_list_index();
    if (i >= count) return;
    const lw_vpl vpl = vpls[i];
    const float values[10] = {vpl.positionArea.x, vpl.positionArea.y, vpl.positionArea.z,
                              vpl.normal.x, vpl.normal.y, vpl.normal.z,
                              vpl.flux.x, vpl.flux.y, vpl.flux.z, vpl.positionArea.w};
    for (int c = 0; c < 10; ++c) planes[c * planeStride + i] = values[c];
}
