// Pull-push over a map's texels (Gortler et al. 1996; for maps of splatted points: Ritschel et al. 2008): coarser levels
// average what is known, and what is not known takes the surface of the coarser level. Known texels stay as they are.
// A level holds LW_FILL_PLANES planes of `stride` floats for each map; texels row by row.
#include "pull_push.h"
#include "shared/paraboloid_map_types.h"

// Texels (x, y) of a map's records, those on its border repeated beyond it.
LW_FN lw_filled load_record(__global const float* records, __global const int* albedo, int first, int size, lanei x, lanei y) {
    const lanei at = y * size + x + first;
    const real distance = gather(records, at * 2);
    const lanei bits = gatheri((__global const int*)records, at * 2 + 1), colour = gatheri(albedo, at);
    const float step = paraboloid_step(size);
    lw_filled f;
    f.known = bits != 0;
    f.point = times_(paraboloid_direction(paraboloid_uv(to_real(x), step), paraboloid_uv(to_real(y), step)),
                     select_((real)(0.0f), distance, f.known));
    f.normal.x = packed_normal(bits, 0);
    f.normal.y = packed_normal(bits, 1);
    f.normal.z = packed_normal(bits, 2);
    f.albedo.x = packed_albedo(colour, 0);
    f.albedo.y = packed_albedo(colour, 1);
    f.albedo.z = packed_albedo(colour, 2);
    return f;
}

LW_FN lw_filled load_level(__global const float* level, int stride, lanei at) {
    lw_filled f;
    real v[LW_FILL_PLANES];
    for (int p = 0; p < LW_FILL_PLANES; ++p) v[p] = gather(level + p * stride, at);
    f.point.x = v[0];
    f.point.y = v[1];
    f.point.z = v[2];
    f.normal.x = v[3];
    f.normal.y = v[4];
    f.normal.z = v[5];
    f.albedo.x = v[6];
    f.albedo.y = v[7];
    f.albedo.z = v[8];
    f.known = dot_(f.point, f.point) > 0.0f;
    return f;
}

LW_FN void store_level(lw_filled f, __global float* level, int stride, int at) {
    const real zero = 0.0f;
    store(select_(zero, f.point.x, f.known), level, at);
    store(select_(zero, f.point.y, f.known), level, at + stride);
    store(select_(zero, f.point.z, f.known), level, at + 2 * stride);
    store(f.normal.x, level, at + 3 * stride);
    store(f.normal.y, level, at + 4 * stride);
    store(f.normal.z, level, at + 5 * stride);
    store(f.albedo.x, level, at + 6 * stride);
    store(f.albedo.y, level, at + 7 * stride);
    store(f.albedo.z, level, at + 8 * stride);
}

// Rows and columns of LW_WIDTH texels from `texel` on, in an image `width` wide; those beyond its end repeat its last.
LW_FN lanei texels_from(int texel, int width) { return min(lanei_iota() + texel, (lanei)(width * width - 1)); }

// One work-item = LW_WIDTH texels (x) of level 1 of a map (y). `strideOut`: floats of a plane, a multiple of 16.
__kernel void pull_push_pull_records(__global const int* states, __global const float* records, __global const int* albedo,
                                     int size, __global float* out, int strideOut) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1), width = size / 2;
    if (texel >= strideOut || !(states[map] & LW_MAP_DRAWN)) return;
    const lanei at = texels_from(texel, width), y = at / width, x = at - y * width;
    lw_filled child[4];
    for (int i = 0; i < 4; ++i)
        child[i] = load_record(records, albedo, map * size * size, size, x * 2 + (i & 1), y * 2 + (i >> 1));
    store_level(pulled(child), out + map * strideOut * LW_FILL_PLANES, strideOut, texel);
}

// The same from one level to the next; `width`: of the finer one.
__kernel void pull_push_pull(__global const int* states, __global const float* in, int strideIn, int width,
                             __global float* out, int strideOut) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1), coarser = width / 2;
    if (texel >= strideOut || !(states[map] & LW_MAP_DRAWN)) return;
    const lanei at = texels_from(texel, coarser), y = at / coarser, x = at - y * coarser;
    lw_filled child[4];
    for (int i = 0; i < 4; ++i)
        child[i] = load_level(in + map * strideIn * LW_FILL_PLANES, strideIn, (y * 2 + (i >> 1)) * width + x * 2 + (i & 1));
    store_level(pulled(child), out + map * strideOut * LW_FILL_PLANES, strideOut, texel);
}

// One work-item = LW_WIDTH texels (x) of a level, `width` wide, of a map (y): unknown ones take the surface of the coarser.
__kernel void pull_push_push(__global const int* states, __global const float* coarse, int strideCoarse, int width,
                             __global float* level, int stride) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1);
    if (texel >= stride || !(states[map] & LW_MAP_DRAWN)) return;
    __global float* own = level + map * stride * LW_FILL_PLANES;
    const lanei at = texels_from(texel, width), y = at / width, x = at - y * width;
    lw_filled f = load_level(own, stride, lanei_iota() + texel);
    if (all_(f.known)) return;
    const lw_filled parent =
        load_level(coarse + map * strideCoarse * LW_FILL_PLANES, strideCoarse, (y / 2) * (width / 2) + x / 2);
    const lw_filled made = pushed(parent, x, y, 2.0f * LW_PARABOLOID_RIM / (float)width);
    f.point = select3_(made.point, f.point, f.known);
    f.normal = select3_(made.normal, f.normal, f.known);
    f.albedo = select3_(made.albedo, f.albedo, f.known);
    f.known = or_(f.known, made.known);
    store_level(f, own, stride, texel);
}

// The same for the map's own texels: one work-item = LW_WIDTH of them (x) of a map (y). `filled` counts.
__kernel void pull_push_push_records(__global const int* states, __global const float* coarse, int strideCoarse, int size,
                                     __global uint* records, __global uint* albedo, volatile __global uint* filled) {
    const int texel = (int)get_global_id(0) * LW_WIDTH, map = (int)get_global_id(1), first = map * size * size;
    if (texel >= size * size || !(states[map] & LW_MAP_DRAWN)) return;
    const lanei at = lanei_iota() + texel, y = at / size, x = at - y * size;
    const mask unknown = gatheri((__global const int*)records, (at + first) * 2 + 1) == 0;
    if (!any_(unknown)) return;
    const lw_filled parent =
        load_level(coarse + map * strideCoarse * LW_FILL_PLANES, strideCoarse, (y / 2) * (size / 2) + x / 2);
    const lw_filled made = pushed(parent, x, y, paraboloid_step(size));
    const mask fill = and_(unknown, made.known);
    if (!any_(fill)) return;
    // Against the ray, as every record's.
    const real turn = select_((real)(1.0f), (real)(-1.0f), dot_(made.normal, made.point) > 0.0f);
    const lw_direction n = times_(made.normal, turn);
    int wanted[LW_WIDTH];
    float distances[LW_WIDTH];
    uint normals[LW_WIDTH], colours[LW_WIDTH];
    store(fill, wanted, 0);
    store(sqrt(dot_(made.point, made.point)), distances, 0);
    store(pack_normal(n.x, n.y, n.z), normals, 0);
    store(pack_albedo(made.albedo.x, made.albedo.y, made.albedo.z), colours, 0);
    for (int l = 0; l < LW_WIDTH; ++l) {
        if (!wanted[l]) continue;
        vstore2((uint2)(as_uint(distances[l]), normals[l]), first + texel + l, records);
        albedo[first + texel + l] = colours[l];
    }
    atomic_add(filled, (uint)count_(fill));
}
