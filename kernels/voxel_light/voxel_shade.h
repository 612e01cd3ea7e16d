// What voxels send out and how opaque they are (docs/techniques/voxel_light.md).
//
// A voxel holds surfaces of areas A (in faces of the voxel) and unit normals n, of which sums are known:
// A, A |n.a| for each axis a, A n. What faces one way along an axis covers F = sum A max(0, n.a) of a
// face, what faces the other way B; of both only the larger counts as opacity, min(1, max(F, B)): in a
// thin wall the two lie behind each other. A ray meets the isotropic voxel's largest axis' opacity.
#ifndef LW_VOXEL_SHADE_H
#define LW_VOXEL_SHADE_H

#include "shared/voxel_format_wide.h"
#include "shared/voxel_light_types.h"

#define VOXEL_SQRT_PI 1.7724539f       // 2 pi Y0: a hemisphere's share of c0
#define VOXEL_HEMISPHERE_1 1.5349901f  // pi Y1: of c1, along its axis
// Radiance above which it is brought down, so that no sum leaves float's range: 1e30 W/m^2/sr.
#define VOXEL_MOST 1e30f

// Surfaces and light of LW_WIDTH voxels.
typedef struct {
    real area, axes[3], normal[3];  // normal: sum of A n over A
    real own[3];                    // radiance of each colour that is the surfaces' own, or thrown back
    real flux[3], towards[3];       // radiance times faces; of all colours together its direction's mean
} lw_voxels;

LW_FN real voxel_share(laneu word, int shift) {
    return (to_real(as_lanei_(word >> (laneu)(uint)shift & (laneu)(1023u))) - 511.0f) * (1.0f / 511.0f);
}
LW_FN real voxel_tenth(laneu word, int shift) {
    return to_real(as_lanei_(word >> (laneu)(uint)shift & (laneu)(1023u))) * (1.0f / 1023.0f);
}
LW_FN real voxel_glow(laneu word, int shift) {
    return to_real(as_lanei_(word >> (laneu)(uint)shift & (laneu)(511u)));
}

// Voxels `at`, at + 1, ... of all slots' 512; in false where none of them has a surface. perFace: 1 /
// (pi a face's area).
LW_FN int load_voxels(__global const float* surfaces, LwVoxelContents contents,
                      __global const float* light, __global const float* arriving, float emission,
                      float perFace, int at, lw_voxels* v) {
    const int plane = contents.slots * LW_VOXEL_BRICK_VOXELS;
    v->area = load(surfaces, LW_SURFACE_AREA * plane + at);
    if (!any_(v->area > 0.0f)) return 0;
    const laneu normal = as_laneu_(load(surfaces, LW_SURFACE_NORMAL * plane + at));
    const laneu glow = as_laneu_(load(surfaces, LW_SURFACE_EMISSION * plane + at));
    const laneu albedo = as_laneu_(load(surfaces, LW_SURFACE_ALBEDO * plane + at));
    // The emission's exponent: m 2^(-e - 9).
    const real glowStep = as_real_(((laneu)(118u) - (glow >> (laneu)27)) << (laneu)23) * emission;
    real brightness = (real)(0.0f);
    for (int c = 0; c < 3; ++c) {
        v->axes[c] = load(surfaces, (LW_SURFACE_AREA_X + c) * plane + at);
        v->normal[c] = voxel_share(normal, 10 * c);
        const real flux = load(light, (LW_LIGHT_FLUX + c) * plane + at);
        brightness += flux;
        v->flux[c] = fmin(flux * perFace, (real)(VOXEL_MOST));
        v->own[c] = voxel_glow(glow, 9 * c) * glowStep;
        if (contents.feedback)
            v->own[c] =
                fma_(voxel_tenth(albedo, 10 * c) * M_1_PI_F, load(arriving, c * plane + at), v->own[c]);
        v->own[c] = fmin(v->own[c], (real)(VOXEL_MOST));
    }
    // Of less the inverse is infinite, and times a direction's 0 no number: what is left of it comes from nowhere.
    const mask lit = brightness >= FLT_MIN;
    const real inverse = select_((real)(0.0f), 1.0f / select_((real)(1.0f), brightness, lit), lit);
    for (int c = 0; c < 3; ++c)
        v->towards[c] = contents.planes > LW_LIGHT_DIRECTION
                            ? load(light, (LW_LIGHT_DIRECTION + c) * plane + at) * inverse
                            : v->normal[c];
    return 1;
}

// Without a division by what may be 0.
LW_FN real voxel_over(real a, real b) {
    const mask some = b > 0.0f;
    return select_((real)(0.0f), a / select_((real)(1.0f), b, some), some);
}

LW_FN real larger_side(const lw_voxels* v, int axis) {
    return 0.5f * (v->axes[axis] + fabs(v->area * v->normal[axis]));
}

// Premultiplied red, green, blue and opacity for all directions.
LW_FN void shade_mean(const lw_voxels* v, real* value) {
    const real covered = fmax(fmax(larger_side(v, 0), larger_side(v, 1)), larger_side(v, 2));
    const real opacity = fmin(covered, (real)(1.0f));
    const real perArea = voxel_over(opacity, v->area);
    for (int c = 0; c < 3; ++c) value[c] = fma_(v->flux[c], perArea, opacity * v->own[c]);
    value[3] = opacity;
}

// The same for rays that go down the axis (sign 1: they see what faces up) or up (-1). aware 1: of what faces the ray alone, light and
// opacity. With the opacity of what faces away, rays that leave a lit wall were dimmed by it, which cost a closed box half of its light. 2: opaque from
// both sides, for cones that read no voxel of the surface that they leave (cone_plane.h).
LW_FN void shade_side(const lw_voxels* v, int axis, float sign, int aware, real* value) {
    if (!aware) {
        const real opacity = fmin(larger_side(v, axis), (real)(1.0f)), perArea = voxel_over(opacity, v->area);
        for (int c = 0; c < 3; ++c) value[c] = fma_(v->flux[c], perArea, opacity * v->own[c]);
        value[3] = opacity;
        return;
    }
    // Of the surfaces, and of the light that they throw back, the share that faces the ray: half of (|n.a| + n.a). Of surfaces both means are
    // known, of light the second, t: if all of it comes from one plane, |t| is 1 and the first is |t.a|; what |t| is short of 1 has
    // the surfaces' own mean. (With the surfaces' alone a lit floor's light in the voxels of its edges is seen from the wall's sides, and
    // the floor too dark.)
    const real most = voxel_over(v->axes[axis], v->area);
    const real facing = fmax(0.5f * (v->axes[axis] + sign * (v->area * v->normal[axis])), (real)(0.0f));
    const real one = fmin(sqrt(fma_(v->towards[0], v->towards[0], fma_(v->towards[1], v->towards[1], v->towards[2] * v->towards[2]))), (real)1.0f);
    const real sent = 0.5f * (fma_(1.0f - one, most, fabs(v->towards[axis])) + sign * v->towards[axis]);
    const real closes = aware == 2 ? larger_side(v, axis) : facing;
    const real opacity = fmin(closes, (real)(1.0f)), kept = voxel_over(opacity, closes);
    // Where more faces away than this way, some of the light fell on the backs of sheets, which nobody sees: a ceiling that the sun lights from
    // above would shine through the tops of its cornices (living room: 4 times the light).
    const real front = voxel_over(facing, fmax(facing, v->axes[axis] - facing));
    for (int c = 0; c < 3; ++c) value[c] = kept * fma_(v->flux[c], sent * front, facing * v->own[c]);
    value[3] = opacity;
}

// Premultiplied c0 and opacity, then c1 of each colour: hemispheres of even radiance about the surfaces'
// and the light's mean normals, whose flux through their own surface two bands keep. Where surfaces face
// both ways only half of them is seen from a side, so that what is seen there is brighter than their
// mean over the sphere, at most by 2.
LW_FN void shade_harmonics(const lw_voxels* v, real* value) {
    shade_mean(v, value);
    const real perArea = voxel_over(value[3], v->area);
    const real facing = sqrt(
        fma_(v->normal[0], v->normal[0], fma_(v->normal[1], v->normal[1], v->normal[2] * v->normal[2])));
    const real seen = 2.0f / (1.0f + fmin(facing, (real)(1.0f)));
    for (int c = 0; c < 3; ++c) {
        const real thrown = v->flux[c] * perArea, own = value[3] * v->own[c];
        for (int axis = 0; axis < 3; ++axis)
            value[4 + 3 * c + axis] =
                seen * VOXEL_HEMISPHERE_1 * fma_(thrown, v->towards[axis], own * v->normal[axis]);
        value[c] *= seen * VOXEL_SQRT_PI;
    }
}

#endif
