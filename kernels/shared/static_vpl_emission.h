// What a point or spot light sends towards a direction: its cone and its profile over the angle.
#ifndef LW_STATIC_VPL_EMISSION_H
#define LW_STATIC_VPL_EMISSION_H

#include "static_vpl_types.h"
#include "wide.h"

// Share of the intensity at this cosine to the axis. The cone as glTF's KHR_lights_punctual has it; `profile`: even
// steps of the angle from 0 to pi, linear in between.
LW_FN real sent_share(__global const float* inputs, lw_static_frame frame, __global const lw_static_light* light, real cosine) {
    const real ramp = clamp(fma_(cosine, light->position.w, light->axis.w), (real)0.0f, (real)1.0f);
    real share = ramp * ramp;
    if (light->profileCount > 0) {
        __global const float* profile = inputs + frame.profiles + light->profile;
        const real steps = (float)(light->profileCount - 1);
        const real at = acos(clamp(cosine, (real)-1.0f, (real)1.0f)) * (M_1_PI_F * steps);
        const real below = fmin(floor(at), steps - 1.0f);
        const lanei index = to_lanei(below);
        const real low = gather(profile, index), high = gather(profile, index + 1);
        share *= fma_(high - low, at - below, low);
    }
    return share;
}

#endif
