// Flux of static VPLs from a frame's lights (Papaioannou 2025, sections 4.1 and 4.2), with the units and errata of
// docs/techniques/static_vpl.md: E at a place by cosine, distance, cone and profile, times soft visibility; Phi =
// reflectance E A.
#include "shared/static_vpl_emission.h"
#include "shared/input_limits.h"

// What a light sends a place may be any number a host can write; sums of 4,096 of them stay finite.
#define LW_LARGEST_SHARE 1e34f

// Soft visibility along the segment from p over d: prod min(1, (distance to the centre / r)^2). `most`: 1, or far for
// segments that go on without end; `scale`: 1 / |d|^2.
LW_FN real past_blockers(__global const float* blockers, int count, const real* p, const real* d, real scale, float most) {
    real visible = (real)1.0f;
    for (int b = 0; b < count; ++b, blockers += 4) {
        const real cx = blockers[0] - p[0], cy = blockers[1] - p[1], cz = blockers[2] - p[2];
        const real along = fma_(cx, d[0], fma_(cy, d[1], cz * d[2])) * scale;
        const real t = clamp(along, (real)0.0f, (real)most);
        const real ex = fma_(-t, d[0], cx), ey = fma_(-t, d[1], cy), ez = fma_(-t, d[2], cz);
        visible *= fmin(fma_(ex, ex, fma_(ey, ey, ez * ez)) * blockers[3], (real)1.0f);
    }
    return visible;
}

// One work-item = LW_WIDTH places. `nearest`: a plane of m^2, of those without an area of their own. The strongest
// intensity that some receivers would get without blockers goes to the frame's first word: bits of floats above 0 are ordered as whole numbers, so
// that the order of work-items does not matter.
__kernel void static_vpl_light_update(__global float* inputs, lw_static_frame frame, __global const float* nearest,
                                      __global float* lit) {
    const int i = (int)get_global_id(0) * LW_WIDTH;
    if (i >= frame.stride) return;
    __global const float* places = inputs + frame.places + i;
    real p[3], n[3], rho[3];
    LW_UNROLL for (int a = 0; a < 3; ++a) {
        p[a] = load(places, (LW_PLACE_POSITION + a) * frame.stride);
        n[a] = load(places, (LW_PLACE_NORMAL + a) * frame.stride);
        rho[a] = load(places, (LW_PLACE_REFLECTANCE + a) * frame.stride);
    }
    const lanei lights = as_lanei_(load(places, LW_PLACE_LIGHTS * frame.stride));
    const lanei receivers = as_lanei_(load(places, LW_PLACE_RECEIVERS * frame.stride));
    // Padding has no receivers. An area by distance would be whatever memory holds there, and no number times no light
    // is no number.
    const real own = load(places, LW_PLACE_AREA * frame.stride);
    const mask byDistance = and_(to_mask(receivers), or_(own == 0.0f, splat_mask(frame.automatic)));
    const real area = select_(own, load(nearest, i), byDistance);
    store(area, lit, LW_LIT_AREA * frame.stride + i);

    real open[2] = {(real)0.0f, (real)0.0f}, sum[2][3] = {{(real)0.0f, (real)0.0f, (real)0.0f}, {(real)0.0f, (real)0.0f, (real)0.0f}};
    __global const lw_static_light* light = (__global const lw_static_light*)(inputs + frame.lights);
    for (int l = 0; l < frame.lightCount; ++l, ++light) {
        if (light->mask == 0) continue;
        const float axis[3] = {light->axis.x, light->axis.y, light->axis.z};
        const float from[3] = {light->position.x, light->position.y, light->position.z};
        const float emitted[3] = {light->emitted.x, light->emitted.y, light->emitted.z};
        const int distant = light->kind == LW_STATIC_DIRECTIONAL;
        real d[3], scale = (real)1.0f, share;
        if (distant) {
            LW_UNROLL for (int a = 0; a < 3; ++a) d[a] = (real)(-axis[a]);
            share = fmax(fma_(n[0], d[0], fma_(n[1], d[1], n[2] * d[2])), (real)0.0f);
        } else {
            LW_UNROLL for (int a = 0; a < 3; ++a) d[a] = from[a] - p[a];
            const real d2 = fmax(fma_(d[0], d[0], fma_(d[1], d[1], d[2] * d[2])), (real)1e-37f);
            scale = 1.0f / d2;
            const real inverse = sqrt(scale);
            const real cosine = fmax(fma_(n[0], d[0], fma_(n[1], d[1], n[2] * d[2])) * inverse, (real)0.0f);
            const real sent = -fma_(axis[0], d[0], fma_(axis[1], d[1], axis[2] * d[2])) * inverse;
            // A place next to a light would get more than the light sends: no more than a hemisphere's.
            share = cosine / fmax(fmax(d2, cosine * area * (0.5f * M_1_PI_F)), (real)1e-37f) * sent_share(inputs, frame, light, sent);
        }
        // (From 1e-37 m^2 with a profile of 1e6 it would be infinite, and no number behind a blocker.)
        share = select_((real)0.0f, fmin(share, (real)LW_LARGEST_SHARE), to_mask(lights & (lanei)light->mask));
        if (!any_(share > 0.0f)) continue;
        const real seen = share * past_blockers(inputs + frame.blockers, frame.blockerCount, p, d, scale, distant ? 3e9f : 1.0f);
        LW_UNROLL for (int r = 0; r < 2; ++r) {
            if (!(light->receivers & (r ? LW_RECEIVER_BAKED : LW_RECEIVER_UNBAKED))) continue;
            LW_UNROLL for (int c = 0; c < 3; ++c) {
                sum[r][c] += fmin(emitted[c] * seen, (real)LW_LARGEST_SHARE);
                open[r] = fma_(fmin(emitted[c] * share, (real)LW_LARGEST_SHARE), rho[c], open[r]);
            }
        }
    }
    real most = (real)0.0f;
    LW_UNROLL for (int r = 0; r < 2; ++r) {
        const mask reaches = to_mask(receivers & (lanei)(r ? LW_RECEIVER_BAKED : LW_RECEIVER_UNBAKED));
        LW_UNROLL for (int c = 0; c < 3; ++c) {
            const real flux = fmin(rho[c] * area * sum[r][c], (real)LW_LARGEST_FLUX);
            store(select_((real)0.0f, flux, reaches), lit, (3 * r + c) * frame.stride + i);
        }
        most = fmax(most, select_((real)0.0f, fmin(open[r] * area, (real)LW_LARGEST_FLUX), reaches));
    }
    const float strongest = max_lane(most) * (M_1_PI_F / 3.0f);
    if (strongest > 0.0f) atomic_max((__global int*)inputs + LW_FRAME_STRONGEST, as_int(strongest));
}
