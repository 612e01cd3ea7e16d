// Light that another camera's picture gives to what this one sees (Soler et al. 2009, section 5, "cooperative screen-space
// illumination"): the larger of both where the other camera sees the same surface.
#include "shared/wide.h"
#include "shared/edge_weight.h"
#include "shared/screen_types.h"

// How far from the surface of a texel a point may lie, in extents of what the texel shows. Larger: points that the other
// camera does not see take light from what hides them. Smaller: none where texels are coarse; a kept point lies up to
// 1.4 extents from the far corner of its texel.
#define LW_JOIN_REACH 2.0f

typedef struct { real v[LW_LIGHT_PLANES], weight; } lw_joined;

// One of the four texels about a point. `at`: its offset in the level's planes, `lit` in the light's.
LW_FN void add_neighbour(lw_joined* sum, const lw_surface* s, real tent, mask inside, lanei at, lanei lit, int plane,
                         int lightPlane, __global const float* texels, __global const float* light, real footprint2) {
    const real px = gather(texels, at), py = gather(texels, at + plane), pz = gather(texels, at + 2 * plane);
    const real nx = gather(texels, at + 3 * plane), ny = gather(texels, at + 4 * plane), nz = gather(texels, at + 5 * plane);
    const real area = gather(texels, at + LW_SENDER_AREA * plane);
    // A texel of area f l shows a surface f wide and l long: l^2 = area^2 / f^2.
    const real extent2 = fmax(area * area / footprint2, footprint2);
    const mask near = squared_length(px - s->px, py - s->py, pz - s->pz) <= (LW_JOIN_REACH * LW_JOIN_REACH) * extent2;
    const real w = select_((real)0.0f, tent * edge_weight(edges_of(*s, (real)1.0f), px, py, pz, nx, ny, nz), and_(inside, near));
    for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum->v[a] = fma_(w, gather(light, lit + a * lightPlane), sum->v[a]);
    sum->weight += w;
}

// One work-item = LW_WIDTH pixels of the host's image, whose outputs it raises. texels, light: the other camera's first
// level, columns x rows texels.
__kernel void screen_combine_join(__global const float* position, int4 positionLayout, __global const float* normal,
                                  int4 normalLayout, int width, int height, __global const float* texels, int4 texelLayout,
                                  int columns, int rows, LwScreenCamera camera, __global const float* light, int4 lightLayout,
                                  int hasIrradiance, __global float* irradiance, int4 irradianceLayout, int hasValidity,
                                  __global float* validity, int4 validityLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const real vx = s.px - camera.eye.x, vy = s.py - camera.eye.y, vz = s.pz - camera.eye.z;
    const real w = fma_(vx, camera.rowW.x, fma_(vy, camera.rowW.y, fma_(vz, camera.rowW.z, camera.rowW.w)));
    const real depth = fma_(vx, camera.axis.x, fma_(vy, camera.axis.y, vz * camera.axis.z));
    const mask before = and_(s.valid, and_(w > 0.0f, lanei_iota() + (lanei)x < (lanei)width));
    const real inverse = select_((real)0.0f, 1.0f / w, before);
    const real u = fma_(vx, camera.rowX.x, fma_(vy, camera.rowX.y, fma_(vz, camera.rowX.z, camera.rowX.w))) * inverse - 0.5f;
    const real v = fma_(vx, camera.rowY.x, fma_(vy, camera.rowY.y, fma_(vz, camera.rowY.z, camera.rowY.w))) * inverse - 0.5f;
    const mask seen = and_(before, and_(and_(u > -1.0f, u < (real)columns), and_(v > -1.0f, v < (real)rows)));
    if (!any_(seen)) return;
    const real left = floor(select_((real)0.0f, u, seen)), top = floor(select_((real)0.0f, v, seen));
    const real fu = u - left, fv = v - top;
    const real z = camera.axis.w != 0.0f ? depth : (real)1.0f;
    const real footprint2 = fmax(camera.eye.w * z * z, (real)1e-37f);
    lw_joined sum;
    for (int a = 0; a < LW_LIGHT_PLANES; ++a) sum.v[a] = (real)0.0f;
    sum.weight = (real)0.0f;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const lanei column = to_lanei(left) + i, row = to_lanei(top) + j;
            const mask inside = and_(seen, and_(and_(column >= (lanei)0, column < (lanei)columns), and_(row >= (lanei)0, row < (lanei)rows)));
            const lanei c = clamp(column, (lanei)0, (lanei)(columns - 1)), r = clamp(row, (lanei)0, (lanei)(rows - 1));
            const real tent = (i ? fu : 1.0f - fu) * (j ? fv : 1.0f - fv);
            add_neighbour(&sum, &s, tent, inside, (lanei)texelLayout.x + r * texelLayout.y + c,
                          (lanei)lightLayout.x + r * lightLayout.y + c, texelLayout.z, lightLayout.z, texels, light, footprint2);
        }
    // A neighbour that just passes the tests would speak for all.
    const mask joined = sum.weight > 1e-3f;
    const real scale = select_((real)0.0f, 1.0f / sum.weight, joined);
    if (hasIrradiance)
        for (int a = 0; a < 3; ++a) {
            const int at = irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y + x;
            store(fmax(load(irradiance, at), fmin(sum.v[a] * scale, (real)LW_LARGEST_IRRADIANCE)), irradiance, at);
        }
    if (hasValidity) {
        const int at = validityLayout.x + y * validityLayout.y + x;
        store(fmax(load(validity, at), fmin(sum.v[LW_LIGHT_SHARE] * scale, (real)1.0f)), validity, at);
    }
}
