// Phantom VPLs of spot lights, and VPLs that send a second bounce (Papaioannou 2025, sections 4.3 and 4.4), with the
// units and errata of docs/techniques/static_vpl.md.
#include "shared/input_limits.h"
#include "shared/rsm_types.h"
#include "shared/static_vpl_emission.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"

// The look of the places around x, by inverse squares of their distances: as shares of the nearest one's, which stay
// in range wherever x lies.
LW_FN void look_at(__global const float* inputs, lw_static_frame frame, __global const float* areas, const float4 x, float eps,
                   lw_phantom_state* state) {
    __global const float* p = inputs + frame.places;
    const int stride = frame.stride;
    float nearest = INFINITY;
    for (int i = 0; i < frame.count; ++i) {
        const float dx = x.x - p[i], dy = x.y - p[i + stride], dz = x.z - p[i + 2 * stride];
        nearest = fmin(nearest, dx * dx + dy * dy + dz * dz);
    }
    nearest += eps;
    float sum = 0.0f, area = 0.0f;
    float4 normal = (float4)(0.0f), rho = (float4)(0.0f);
    for (int i = 0; i < frame.count; ++i) {
        const float dx = x.x - p[i], dy = x.y - p[i + stride], dz = x.z - p[i + 2 * stride];
        const float away = dx * dx + dy * dy + dz * dz + eps;
        const float b = away > 0.0f ? nearest / away : 1.0f;
        __global const float* n = p + LW_PLACE_NORMAL * stride + i;
        __global const float* r = p + LW_PLACE_REFLECTANCE * stride + i;
        sum += b;
        area += b * areas[i];
        normal += b * (float4)(n[0], n[stride], n[2 * stride], 0.0f);
        rho += b * (float4)(r[0], r[stride], r[2 * stride], 0.0f);
    }
    state->normal = normal / sum;
    state->normal.w = area / sum;
    state->reflectance = rho / sum;
}

LW_FN float4 unit_or_none(float4 v) {
    const float squared = v.x * v.x + v.y * v.y + v.z * v.z;
    return squared > 1e-12f ? (float4)(v.xyz * rsqrt(squared), v.w) : (float4)(0.0f, 0.0f, 0.0f, v.w);
}

// A VPL that faces along `normal` and sends what lies opposite, at distance d, catches of `flux`.
LW_FN lw_vpl opposite_vpl(float4 position, float4 normal, float d, float4 flux, lw_phantom_options options) {
    lw_vpl vpl = no_vpl();
    const float whole = M_PI_F * d * d;
    const float area = options.area > 0.0f ? fmin(options.area, whole) : whole;
    if (!(whole > 0.0f)) return vpl;
    vpl.positionArea = (float4)(position.xyz, area);
    vpl.normal = (float4)(normal.xyz, 0.0f);
    vpl.flux = fmin(flux * (options.reflectance * (area / whole)), LW_LARGEST_FLUX);
    return bounded(vpl);
}

LW_FN void put(lw_vpl vpl, int receivers, int lists, int slot, __global lw_vpl* vpls, __global lw_vpl* baked) {
    vpls[slot] = receivers & LW_RECEIVER_UNBAKED ? vpl : no_vpl();
    if (lists > 1) baked[slot] = receivers & LW_RECEIVER_BAKED ? vpl : no_vpl();
}

// One work-item = one spot light. Its phantom is number count + item of the list, the VPL opposite follows all
// phantoms. `lit`: planes of the places. A light whose axis meets nothing has no phantom.
__kernel void phantom_vpl_make(__global const float* inputs, lw_static_frame frame, __global const float* lit,
                               __global const float* texels, int4 layout, lw_phantom_options options,
                               __global lw_phantom_state* states, lw_subset_order order, __global lw_vpl* vpls, __global lw_vpl* baked) {
    const int item = (int)get_global_id(0);
    if (item >= frame.phantomCount) return;
    const lw_phantom phantom = ((__global const lw_phantom*)(inputs + frame.phantoms))[item];
    __global const lw_static_light* light = (__global const lw_static_light*)(inputs + frame.lights) + phantom.light;
    float4 x = phantom.hit;
    if (!(x.w > 0.0f)) {
        __global const float* t = texels + layout.x + phantom.texel;
        const float nx = t[LW_RSM_NORMAL * layout.z], ny = t[(LW_RSM_NORMAL + 1) * layout.z], nz = t[(LW_RSM_NORMAL + 2) * layout.z];
        x = (float4)(t[0], t[layout.z], t[2 * layout.z], nx * nx + ny * ny + nz * nz > 0.0f ? 1.0f : 0.0f);
    }
    lw_vpl first = no_vpl(), second = no_vpl();
    lw_phantom_state now;
    now.position = x;
    now.normal = now.reflectance = (float4)(0.0f);
    if (x.w > 0.0f && frame.count > 0) {
        look_at(inputs, frame, lit + LW_LIT_AREA * frame.stride, x, options.eps, &now);
        const lw_phantom_state before = states[item];
        if (options.keep && before.position.w > 0.0f) {
            now.position = mix(now.position, before.position, options.smoothing);
            now.normal = mix(now.normal, before.normal, options.smoothing);
            now.reflectance = mix(now.reflectance, before.reflectance, options.smoothing);
        }
        const float4 normal = unit_or_none(now.normal);
        const float4 d = (float4)(light->position.xyz - now.position.xyz, 0.0f);
        const float d2 = fmax(d.x * d.x + d.y * d.y + d.z * d.z, 1e-37f), h = sqrt(d2);
        const float cosine = fmax(normal.x * d.x + normal.y * d.y + normal.z * d.z, 0.0f) / h;
        const float sent = -(light->axis.x * d.x + light->axis.y * d.y + light->axis.z * d.z) / h;
        // No more than a hemisphere's light, as of static VPLs.
        const float share = cosine / fmax(fmax(d2, cosine * normal.w * (0.5f * M_1_PI_F)), 1e-37f) *
                            min_lane(sent_share(inputs, frame, light, (real)sent));
        const float4 emitted = (float4)(light->emitted.xyz, 0.0f);
        first.positionArea = (float4)(now.position.xyz, normal.w);
        first.normal = (float4)(normal.xyz, 0.0f);
        first.flux = fmin(now.reflectance * normal.w * fmin(emitted * fmin(share, 1e34f), 1e34f), LW_LARGEST_FLUX);
        first = bounded(first);
        if (options.opposite) {
            // Half as far behind the light as the phantom lies ahead of it, and facing that.
            const float4 behind = (float4)(now.position.xyz - light->axis.xyz * (1.5f * h), 0.0f);
            second = opposite_vpl(behind, light->axis, 1.5f * h, first.flux, options);
        }
    }
    states[item] = now;
    put(first, light->receivers, options.lists, lw_subset_slot(order, frame.count + item), vpls, baked);
    if (options.opposite)
        put(second, light->receivers, options.lists, lw_subset_slot(order, frame.count + frame.phantomCount + item), vpls, baked);
}

// One work-item in all: the VPL opposite the static ones that are kept, the last of the list. Its place is their mean
// by intensity, moved along their mean normal; sums, so that splitting VPLs changes nothing. Light from all around
// has no mean normal (shorter than 1e-3), and no VPL lies opposite it.
__kernel void phantom_vpl_opposite(lw_static_frame frame, lw_phantom_options options, lw_subset_order order, __global lw_vpl* vpls,
                                   __global lw_vpl* baked) {
    if (get_global_id(0) != 0) return;
    float4 first = (float4)(0.0f), second = (float4)(0.0f), position = (float4)(0.0f), normal = (float4)(0.0f);
    float sum = 0.0f;
    for (int k = 0; k < frame.count; ++k) {
        const int slot = lw_subset_slot(order, k);
        const float4 flux = vpls[slot].flux, other = options.lists > 1 ? baked[slot].flux : (float4)(0.0f);
        const float weight = flux.x + flux.y + flux.z + other.x + other.y + other.z;
        if (!(weight > 0.0f)) continue;
        first += flux;
        second += other;
        sum += weight;
        // Means that run along: sums of fluxes times places leave float's range.
        const float share = weight / sum;
        position += share * (vpls[slot].positionArea - position);
        normal += share * (vpls[slot].normal - normal);
    }
    lw_vpl a = no_vpl(), b = no_vpl();
    if (sum > 0.0f) {
        const float size = sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
        if (size >= 1e-3f) {
            normal /= size;
            position += normal * options.distance;
            a = opposite_vpl(position, -normal, options.distance, first, options);
            b = opposite_vpl(position, -normal, options.distance, second, options);
        }
    }
    const int slot = lw_subset_slot(order, frame.count + 2 * frame.phantomCount);
    vpls[slot] = a;
    if (options.lists > 1) baked[slot] = b;
}
