// VPLs as no more than so many lights: each light stands for VPLs near it that face the same way, k-means by flux
// from where the frame before left it (Lloyd's iteration, one step a frame). All flux is kept; a light that has lost
// its VPLs begins anew at the VPL that is worst represented, and no other light's number changes.
#include "shared/static_vpl_types.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"

// What facing apart counts against lying apart, as squares of shares of the scene's diagonal: perpendicular normals
// are as far as half of it. Smaller: lights stand in the air between walls. Larger: one light for each way of facing,
// however far apart.
#define LW_FACING 0.125f

// Closer than this, squared, two places are one: what rounding leaves of a VPL that has a light to itself.
#define LW_SAME 1e-10f

LW_FN float flux_of(const lw_vpl vpl) { return vpl.flux.x + vpl.flux.y + vpl.flux.z; }

// Squared distance of a VPL to a light. scale: 1 / diagonal^2.
LW_FN float apart(float4 position, float4 normal, lw_listed_centre centre, float scale) {
    const float4 d = position - centre.position;
    const float facing = 1.0f - (normal.x * centre.normal.x + normal.y * centre.normal.y + normal.z * centre.normal.z);
    return (d.x * d.x + d.y * d.y + d.z * d.z) * scale + 2.0f * LW_FACING * fmax(facing, 0.0f);
}

// One work-item = one VPL of `order.count`: its light, or -1, and what is lost by that, its flux times the squared
// distance. alone: 1 where each can have a light of its own number.
__kernel void light_list_assign(__global const lw_vpl* vpls, __global const lw_vpl* baked, int lists, lw_subset_order order,
                                float scale, int alone, __global const lw_listed_centre* centres, int most, __global int* assignment,
                                __global float* losses) {
    const int k = lw_list_index();
    if (k >= order.count) return;
    const int slot = lw_subset_slot(order, k);
    const lw_vpl vpl = vpls[slot];
    float4 normal = vpl.normal, position = vpl.positionArea;
    float weight = flux_of(vpl);
    if (lists > 1) {
        const lw_vpl other = baked[slot];
        weight += flux_of(other);
        // One of them may be empty.
        position = weight > 0.0f && flux_of(vpl) == 0.0f ? other.positionArea : position;
        normal = weight > 0.0f && flux_of(vpl) == 0.0f ? other.normal : normal;
    }
    int light = -1;
    float least = INFINITY;
    for (int m = 0; m < most && weight > 0.0f && !alone; ++m) {
        if (!(centres[m].position.w > 0.0f)) continue;
        const float distance = apart(position, normal, centres[m], scale);
        if (distance < least) {
            least = distance;
            light = m;
        }
    }
    if (alone && weight > 0.0f) light = k;
    assignment[k] = light;
    losses[k] = !(weight > 0.0f) || alone ? 0.0f : light < 0 ? weight : least > LW_SAME ? weight * least : 0.0f;
}

// One work-item in all: lights without VPLs begin anew, one after the other, each at the VPL with the greatest loss.
__kernel void light_list_begin(__global const lw_vpl* vpls, __global const lw_vpl* baked, int lists, lw_subset_order order, float scale,
                               __global lw_listed_centre* centres, int most, __global const int* assignment, __global float* losses) {
    if (get_global_id(0) != 0) return;
    int members[LW_MOST_LISTED];
    for (int m = 0; m < most; ++m) members[m] = 0;
    for (int k = 0; k < order.count; ++k)
        if (assignment[k] >= 0) ++members[assignment[k]];
    for (int m = 0; m < most; ++m) {
        if (members[m] > 0) continue;
        centres[m].position.w = 0.0f;
        int worst = -1;
        for (int k = 0; k < order.count; ++k)
            if (losses[k] > (worst < 0 ? 0.0f : losses[worst])) worst = k;
        if (worst < 0) continue;
        const int chosen = lw_subset_slot(order, worst);
        lw_vpl vpl = vpls[chosen];
        if (lists > 1 && flux_of(vpl) == 0.0f) vpl = baked[chosen];
        lw_listed_centre centre;
        centre.position = (float4)(vpl.positionArea.xyz, 1.0f);
        centre.normal = (float4)(vpl.normal.xyz, 0.0f);
        centres[m] = centre;
        for (int k = 0; k < order.count; ++k) {
            if (!(losses[k] > 0.0f)) continue;
            const int slot = lw_subset_slot(order, k);
            const lw_vpl own = vpls[slot];
            float weight = flux_of(own);
            float4 position = own.positionArea, normal = own.normal;
            if (lists > 1) {
                if (weight == 0.0f) position = baked[slot].positionArea, normal = baked[slot].normal;
                weight += flux_of(baked[slot]);
            }
            const float distance = apart(position, normal, centre, scale);
            losses[k] = distance > LW_SAME ? fmin(losses[k], weight * distance) : 0.0f;
        }
    }
}

// One work-item = one light: the sums of its VPLs, in their order, and where the next frame begins.
__kernel void light_list_sum(__global const lw_vpl* vpls, __global const lw_vpl* baked, int lists, lw_subset_order order,
                             __global const int* assignment, __global lw_listed_centre* centres, int most,
                             __global lw_listed_light* listed) {
    const int m = (int)get_global_id(0);
    if (m >= most) return;
    float4 flux = (float4)(0.0f), other = (float4)(0.0f), position = (float4)(0.0f), normal = (float4)(0.0f);
    float sum = 0.0f, area = 0.0f;
    uint members = 0;
    for (int k = 0; k < order.count; ++k) {
        if (assignment[k] != m) continue;
        const int slot = lw_subset_slot(order, k);
        lw_vpl vpl = vpls[slot];
        float weight = flux_of(vpl);
        flux += vpl.flux;
        if (lists > 1) {
            if (weight == 0.0f) vpl = baked[slot];
            weight += flux_of(baked[slot]);
            other += baked[slot].flux;
        }
        // Means that run along, by shares: sums of fluxes times places, or squares of such sums, leave float's range on
        // both sides, and a light of one VPL lies exactly there.
        ++members;
        sum += weight;
        const float share = weight / sum;
        area += vpl.positionArea.w;
        position += share * (vpl.positionArea - position);
        normal += share * (vpl.normal - normal);
    }
    lw_listed_light light;
    const float size = sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
    const float4 axis = members == 0 ? (float4)(0.0f) : size > 0.0f ? normal / size : (float4)(0.0f, 0.0f, 1.0f, 0.0f);
    light.positionArea = (float4)(position.xyz, area);
    light.axis[0] = axis.x;
    light.axis[1] = axis.y;
    light.axis[2] = axis.z;
    light.id = (uint)m;
    light.flux[0] = flux.x;
    light.flux[1] = flux.y;
    light.flux[2] = flux.z;
    light.vpls = members;
    const float4 second = lists > 1 ? other : flux;
    light.bakedFluxCone = (float4)(second.xyz, 85.0f / 180.0f * M_PI_F);
    // A cone of half angle a fills 2 pi (1 - cos a) = 5.7355713 sr.
    light.spotIntensity = (float4)(flux.xyz / 5.7355713f, 0.0f);
    listed[m] = light;
    lw_listed_centre centre;
    centre.position = (float4)(position.xyz, members ? 1.0f : 0.0f);
    centre.normal = axis;
    centres[m] = centre;
}
