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

// What the map saw in the texel of a direction of its frame, along that texel's centre ray.
LW_FN lw_met surface_met(lw_paraboloid map, __global const float* records, __global const uint* albedo, int firstRecord,
                         int size, float3 direction) {
    const float step = 2.0f * LW_PARABOLOID_RIM / (float)size, scale = 1.0f / (1.0f + direction.z);
    const int x = clamp((int)((direction.x * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    const int y = clamp((int)((direction.y * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    const int record = firstRecord + y * size + x;
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

// The same of another cluster, as far as its map sees the surface. A surface as far away as the texel's, give or take a
// texel's slant, is the one that the texel saw.
LW_FN float radiosity_of(lw_cluster cluster, lw_paraboloid map, __global const float* records, int size, lw_met met) {
    const float slack = 1.05f;
    float4 way = met.position - map.origin;
    way.w = 0.0f;
    const float r2 = dot(way, way), cosine = dot(way, map.axisZ) * rsqrt(fmax(r2, FLT_MIN));
    const float facing = -dot(met.normal, way) * rsqrt(fmax(r2, FLT_MIN));
    if (!(cluster.position.w > 0.0f && cosine > 0.0f && facing > 0.0f && r2 > 0.0f)) return 0.0f;
    const float distance = sqrt(r2), step = 2.0f * LW_PARABOLOID_RIM / (float)size, scale = 1.0f / (distance * (1.0f + cosine));
    const int x = clamp((int)((dot(way, map.axisX) * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    const int y = clamp((int)((dot(way, map.axisY) * scale + LW_PARABOLOID_RIM) / step), 0, size - 1);
    if (distance > records[2 * (y * size + x)] * slack) return 0.0f;
    return radiosity_from(cluster, met, cosine, facing, r2);
}

// One work-item = one VPL: sample i % perCluster of cluster i / perCluster. albedo: packed, one word per texel.
__kernel void second_bounce_draw(__global const lw_cluster* clusters, __global const lw_paraboloid* frames,
                                 __global const float* records, __global const uint* albedo, int size, int clusterCount,
                                 int perCluster, int directions, float2 shift, __global lw_vpl* vpls) {
    const int i = lw_list_index();
    if (i >= clusterCount * perCluster) return;
    const int c = i / perCluster, k = i - c * perCluster;
    vpls[i] = no_vpl();
    const lw_cluster cluster = clusters[c];
    if (!(cluster.position.w > 0.0f)) return;

    // Each cluster takes the set turned by another amount: alike, clusters side by side would light alike places.
    const float turn = (float)c * 0.61803399f, turned = turn - floor(turn);
    // The middle of each stratum: at the square's edge a direction lies in the cluster's own plane.
    const float middle = 0.5f / (float)perCluster;
    const float2 point = (float2)(wrap_unit((float)k / (float)perCluster + middle + shift.x),
                                  wrap_unit(wrap_unit(radical_inverse((uint)k) + middle + shift.y) + turned));
    const lw_drawn drawn = draw_direction(directions, point);
    if (!(drawn.direction.z > 0.0f)) return;
    const lw_paraboloid frame = frames[c];
    const lw_met met = surface_met(frame, records, albedo, c * size * size, size, drawn.direction);
    if (!met.any) return;

    const float share = drawn.direction.z * M_1_PI_F / (drawn.density * (float)perCluster);
    const float facing = fmax(-dot(met.normal.xyz, met.direction.xyz), LW_STEEPEST_COSINE);
    lw_vpl vpl;
    vpl.positionArea = met.position;
    const float own = radiosity_from(cluster, met, drawn.direction.z, facing, met.distance * met.distance);
    float all = own;
    // Where every VPL is a cluster, all count as one: asking each for each would take the square of their number.
    if (clusterCount > LW_MOST_SORTED) all = own * (float)clusterCount;
    else
        for (int other = 0; other < clusterCount; ++other)
            if (other != c) all += radiosity_of(clusters[other], frames[other], records + 2 * other * size * size, size, met);
    vpl.positionArea.w = sum_of(met.albedo * cluster.flux) * share / all;
    vpl.normal = met.normal;
    vpl.flux = met.albedo * cluster.flux * share;
    vpl.flux.w = 0.0f;
    if (isfinite(vpl.positionArea.w)) vpls[i] = bounded(vpl);
}
