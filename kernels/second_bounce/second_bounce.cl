// Second-bounce VPLs (Aranha et al. 2020, section II.B): what a cluster lights, sampled from its paraboloid map.
//
// A cluster of flux Phi sends Phi/pi cos(theta) per solid angle about its normal. A direction drawn with density
// pdf per solid angle meets a surface of albedo rho, which reflects in all
//     Phi_2 = rho Phi cos / (pi pdf M),      of M samples,
// and stands for the area that so much flux leaves: A_2 = Phi_2 / B, B the radiosity that all clusters together cause
// at its place, as their maps see it. (The one cluster alone would make it r^2 / (c pdf M), c the cosine at the surface; but
// where several clusters see the same surface, their VPLs together must not stand for more than there is of it, or
// bounding takes light from each: with 32 clusters a fifth. And where others do not see it, smaller areas would be spots.)
// A surface nearer to a cluster than it is wide is lit by a disc, not by a point: r^2 counts as A / 4 pi at least, A the
// members' area. Without that, a VPL beside the medoid would send all its light from a bright stain of no size.
// The paper weighs all samples alike; by the densities below the mean is the map's integral whatever the pattern.
#include "shared/cluster_types.h"
#include "shared/hammersley.h"
#include "shared/paraboloid_types.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

#define LW_DIRECTIONS_COSINE 0  // density cos/pi: every sample carries the same
#define LW_DIRECTIONS_DISC 1    // uniform on the map's unit disc, the paper's
#define LW_DIRECTIONS_SQUARE 2  // uniform on the square about it: a fifth of the samples falls beside the disc

// A surface seen at a grazing angle stands for an area of this many times what it would face on, at most: beyond,
// bounding would take all of its light.
#define LW_STEEPEST_COSINE 0.05f

typedef struct {
    float3 direction;  // in the map's frame; z is 0 or less where the sample is wasted
    float density;     // per solid angle
} lw_drawn;

// Shirley and Chiu's concentric map of the unit square to the unit disc: neighbours stay neighbours.
LW_FN float2 concentric(float2 point) {
    const float a = 2.0f * point.x - 1.0f, b = 2.0f * point.y - 1.0f;
    if (a == 0.0f && b == 0.0f) return (float2)(0.0f, 0.0f);
    const int steep = fabs(b) > fabs(a);
    const float radius = steep ? b : a, turn = (M_PI_4_F) * (steep ? a / b : b / a);
    const float c = cos(turn), s = sin(turn);
    return steep ? (float2)(radius * s, radius * c) : (float2)(radius * c, radius * s);
}

LW_FN lw_drawn draw_direction(int directions, float2 point) {
    lw_drawn drawn;
    if (directions == LW_DIRECTIONS_COSINE) {
        const float2 d = concentric(point);
        const float z = sqrt(fmax(1.0f - d.x * d.x - d.y * d.y, 0.0f));
        drawn.direction = (float3)(d.x, d.y, z);
        drawn.density = z * M_1_PI_F;
        return drawn;
    }
    const int onDisc = directions == LW_DIRECTIONS_DISC;
    const float2 d = onDisc ? concentric(point) : (float2)(2.0f * point.x - 1.0f, 2.0f * point.y - 1.0f);
    // The map's (u, v) = d.xy / (1 + d.z): a solid angle is 4 / (1 + r^2)^2 of the area on the disc.
    const float r2 = d.x * d.x + d.y * d.y, scale = 1.0f / (1.0f + r2);
    drawn.direction = (float3)(2.0f * scale * d.x, 2.0f * scale * d.y, (1.0f - r2) * scale);
    drawn.density = (onDisc ? M_1_PI_F : 0.25f) * (1.0f + r2) * (1.0f + r2) * 0.25f;
    return drawn;
}

typedef struct {
    float4 position, normal, albedo, direction;  // in the world; direction: from the map to the surface
    float distance;
    int any;
} lw_met;

LW_FN float unpacked(uint bits, int field, float offset, float scale) {
    return ((float)((bits >> (10 * field)) & 1023u) - offset) * scale;
}

LW_FN float4 to_world(lw_paraboloid map, float x, float y, float z) {
    const float4 v = map.axisX * x + map.axisY * y + map.axisZ * z;
    return (float4)(v.xyz, 0.0f);
}

// The texel of a map that a direction of its frame falls on.
LW_FN int texel_towards(int size, float3 direction) {
    const float step = 2.0f * LW_PARABOLOID_RIM / (float)size, scale = 1.0f / (1.0f + direction.z);
    const int x = clamp((int)((direction.x * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    const int y = clamp((int)((direction.y * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    return y * size + x;
}

// What the map saw in a texel, along its centre ray.
LW_FN lw_met surface_met(lw_paraboloid map, __global const float* records, __global const uint* albedo, int firstRecord, int size,
                         int texel) {
    const float step = 2.0f * LW_PARABOLOID_RIM / (float)size;
    const int y = texel / size, x = texel - y * size, record = firstRecord + texel;
    const uint normal = as_uint(records[2 * record + 1]), colour = albedo[record];
    const float u = ((float)x + 0.5f) * step - LW_PARABOLOID_RIM, v = ((float)y + 0.5f) * step - LW_PARABOLOID_RIM;
    const float unit = 1.0f / (1.0f + u * u + v * v);
    lw_met met;
    met.any = (normal & LW_PARABOLOID_HIT) != 0u;
    met.distance = met.any ? records[2 * record] : 0.0f;
    met.direction = to_world(map, 2.0f * u * unit, 2.0f * v * unit, (1.0f - u * u - v * v) * unit);
    met.position = map.origin + met.direction * met.distance;
    met.normal = to_world(map, unpacked(normal, 0, 512.0f, 1.0f / 511.0f), unpacked(normal, 1, 512.0f, 1.0f / 511.0f),
                          unpacked(normal, 2, 512.0f, 1.0f / 511.0f));
    met.normal.w = 0.0f;
    met.normal *= rsqrt(fmax(dot(met.normal, met.normal), 0.25f));
    met.albedo = (float4)(unpacked(colour, 0, 0.0f, 1.0f / 1023.0f), unpacked(colour, 1, 0.0f, 1.0f / 1023.0f),
                          unpacked(colour, 2, 0.0f, 1.0f / 1023.0f), 0.0f);
    return met;
}

LW_FN float sum_of(float4 colour) { return colour.x + colour.y + colour.z; }

// Radiosity at a surface, its channels summed up, that a cluster causes from a distance whose square is r2, under these
// cosines.
LW_FN float radiosity_from(lw_cluster cluster, lw_met met, float cosine, float facing, float r2) {
    const float nearest = cluster.flux.w * (0.25f * M_1_PI_F);
    return sum_of(met.albedo * cluster.flux) * cosine * facing * M_1_PI_F / fmax(r2, nearest);
}

// LW_WIDTH samples: the texels that they fall on (none: -1), the cosines there, and what each met: position, normal, albedo, the radiosity
// that its own cluster causes there, that cluster.
typedef struct { int texel[LW_WIDTH]; float cosine[LW_WIDTH], values[10][LW_WIDTH]; int cluster[LW_WIDTH]; float share[LW_WIDTH]; } lw_samples;

LW_FN real dot3(const real* a, float4 b) { return fma_(a[0], b.x, fma_(a[1], b.y, a[2] * b.z)); }

// The radiosity that all clusters cause where the samples met something, each as far as its map sees the surface. A surface as far away as
// the texel's, give or take a texel's slant, is the one that the texel saw.
LW_FN real radiosity_of_all(const lw_samples* samples, __global const lw_cluster* clusters, __global const lw_paraboloid* frames,
                            __global const float* records, int size, int clusterCount) {
    const float slack = 1.05f, step = 2.0f * LW_PARABOLOID_RIM / (float)size;
    real met[9];
    LW_UNROLL for (int a = 0; a < 9; ++a) met[a] = load(samples->values[a], 0);
    const lanei own = loadi(samples->cluster, 0);
    real all = load(samples->values[9], 0);
    for (int other = 0; other < clusterCount; ++other) {
        if (!(clusters[other].position.w > 0.0f)) continue;
        const lw_paraboloid map = frames[other];
        const real way[3] = {met[0] - map.origin.x, met[1] - map.origin.y, met[2] - map.origin.z};
        const real r2 = fma_(way[0], way[0], fma_(way[1], way[1], way[2] * way[2]));
        const real distance = sqrt(fmax(r2, (real)FLT_MIN));
        const real cosine = dot3(way, map.axisZ) / distance;
        const real facing = -fma_(met[3], way[0], fma_(met[4], way[1], met[5] * way[2])) / distance;
        const mask lit = and_(and_(cosine > 0.0f, facing > 0.0f), and_(r2 > FLT_MIN, own != (lanei)other));
        if (!any_(lit)) continue;
        const real scale = 1.0f / (distance * (1.0f + select_((real)0.0f, cosine, lit)));
        const lanei last = (lanei)(size - 1);
        const lanei x = clamp(to_lanei((dot3(way, map.axisX) * scale + LW_PARABOLOID_RIM) / step), (lanei)0, last);
        const lanei y = clamp(to_lanei((dot3(way, map.axisY) * scale + LW_PARABOLOID_RIM) / step), (lanei)0, last);
        const real seen = gather(records + 2 * other * size * size, 2 * (y * size + x));
        const float4 flux = clusters[other].flux;
        const real sent = fma_(met[6], flux.x, fma_(met[7], flux.y, met[8] * flux.z));
        const real radiosity = sent * cosine * facing * M_1_PI_F / fmax(r2, (real)(flux.w * (0.25f * M_1_PI_F)));
        all += select_((real)0.0f, radiosity, and_(lit, distance <= seen * slack));
    }
    return all;
}

// Where sample i % perCluster of cluster i / perCluster goes, as lane l of `samples`, and a hint that its texel will be loaded. Maps are
// larger than what processors keep near, and a sample that waits for its own texel alone waits for as long as all of them together.
LW_FN void aim_sample(lw_samples* samples, int l, int i, __global const lw_cluster* clusters, __global const float* records,
                      __global const uint* albedo, int size, int perCluster, int directions, float2 shift) {
    const int c = i / perCluster, k = i - c * perCluster;
    samples->cluster[l] = c;
    samples->texel[l] = -1;
    if (!(clusters[c].position.w > 0.0f)) return;

    // Each cluster takes the set turned by another amount: alike, clusters side by side would light alike places.
    const float turn = (float)c * 0.61803399f, turned = turn - floor(turn);
    // The middle of each stratum: at the square's edge a direction lies in the cluster's own plane.
    const float middle = 0.5f / (float)perCluster;
    const float2 point = (float2)(wrap_unit((float)k / (float)perCluster + middle + shift.x),
                                  wrap_unit(wrap_unit(radical_inverse((uint)k) + middle + shift.y) + turned));
    const lw_drawn drawn = draw_direction(directions, point);
    if (!(drawn.direction.z > 0.0f)) return;
    samples->texel[l] = texel_towards(size, drawn.direction);
    samples->cosine[l] = drawn.direction.z;
    samples->share[l] = drawn.direction.z * M_1_PI_F / (drawn.density * (float)perCluster);
    const int record = c * size * size + samples->texel[l];
    will_load(records + 2 * record);
    will_load((__global const float*)(albedo + record));
}

// What the sample of lane l has met; 0 where it is wasted.
LW_FN int draw_sample(lw_samples* samples, int l, __global const lw_cluster* clusters, __global const lw_paraboloid* frames,
                      __global const float* records, __global const uint* albedo, int size) {
    if (samples->texel[l] < 0) return 0;
    const int c = samples->cluster[l];
    const lw_met met = surface_met(frames[c], records, albedo, c * size * size, size, samples->texel[l]);
    if (!met.any) return 0;
    const float facing = fmax(-dot(met.normal.xyz, met.direction.xyz), LW_STEEPEST_COSINE);
    const float values[10] = {met.position.x, met.position.y, met.position.z, met.normal.x, met.normal.y, met.normal.z,
                              met.albedo.x,   met.albedo.y,   met.albedo.z,
                              radiosity_from(clusters[c], met, samples->cosine[l], facing, met.distance * met.distance)};
    for (int a = 0; a < 10; ++a) samples->values[a][l] = values[a];
    return 1;
}

// One work-item = LW_WIDTH VPLs. albedo: packed, one word per texel.
__kernel void second_bounce_draw(__global const lw_cluster* clusters, __global const lw_paraboloid* frames,
                                 __global const float* records, __global const uint* albedo, int size, int clusterCount,
                                 int perCluster, int directions, float2 shift, __global lw_vpl* vpls) {
    const int begin = lw_list_index() * LW_WIDTH, count = min(LW_WIDTH, clusterCount * perCluster - begin);
    if (count <= 0) return;
    lw_samples samples;
    for (int l = 0; l < count; ++l) aim_sample(&samples, l, begin + l, clusters, records, albedo, size, perCluster, directions, shift);
    uint drawn = 0;
    for (int l = 0; l < LW_WIDTH; ++l) {
        // A wasted lane lies nowhere: no cluster lights what has no albedo.
        for (int a = 0; a < 10; ++a) samples.values[a][l] = 0.0f;
        if (l < count && draw_sample(&samples, l, clusters, frames, records, albedo, size)) drawn |= 1u << l;
        else samples.cluster[l] = -1;
    }
    float all[LW_WIDTH];
    // Where every VPL is a cluster, all count as one: asking each for each would take the square of their number.
    if (clusterCount > LW_MOST_SORTED) store(load(samples.values[9], 0) * (float)clusterCount, all, 0);
    else if (drawn) store(radiosity_of_all(&samples, clusters, frames, records, size, clusterCount), all, 0);
    for (int l = 0; l < count; ++l) {
        lw_vpl vpl = no_vpl();
        if (drawn >> l & 1u) {
            const float4 flux = clusters[samples.cluster[l]].flux;
            const float4 colour = (float4)(samples.values[6][l], samples.values[7][l], samples.values[8][l], 0.0f);
            vpl.positionArea = (float4)(samples.values[0][l], samples.values[1][l], samples.values[2][l],
                                        sum_of(colour * flux) * samples.share[l] / all[l]);
            vpl.normal = (float4)(samples.values[3][l], samples.values[4][l], samples.values[5][l], 0.0f);
            vpl.flux = colour * flux * samples.share[l];
            vpl.flux.w = 0.0f;
            vpl = isfinite(vpl.positionArea.w) ? bounded(vpl) : no_vpl();
        }
        vpls[begin + l] = vpl;
    }
}
