// One cluster's paraboloid map as kernels and host share it: where it stands, how directions fall on its
// texels, what a texel holds. Functions on lanes: paraboloid.h.
#ifndef LW_PARABOLOID_TYPES_H
#define LW_PARABOLOID_TYPES_H

#include "portable.h"

// A map reaches this far from its axis. A hemisphere would do for VPLs with the cluster's own normal; members'
// normals differ from the mean, and what they light beyond 90 degrees would count as dark. Raised, the same
// texels cover more; lowered, what the members that are tilted most light is shadowed. 105 degrees: half the tilt
// beyond which k-means (weight of normals 0.4) opens another cluster.
// The disc's radius is the stereographic image of that angle, tan(105 / 2 degrees); the cosine is that of 105.
#define LW_PARABOLOID_RIM 1.3032254f
#define LW_PARABOLOID_RIM_COSINE (-0.25881905f)

// The medoid lies on a surface, which its own map would see at distance 0 and, by rounding, at negative ones:
// the map is drawn from a point this share of the geometry's diagonal above it. Relative to the diagonal as the
// rounding of positions is. Raised, maps look over what stands close to the surface; lowered, surfaces as a
// coarse mesh and a finer RSM know them cover each other's light.
#define LW_PARABOLOID_LIFT 1e-4f

// An orthonormal frame with z along the cluster's normal.
typedef struct {
    lw_float4 origin;  // m; w: 1, or 0 for the map of an empty cluster, where nothing is drawn
    lw_float4 axisX;   // unit; w: how far the origin was lifted off the medoid, m
    lw_float4 axisY;
    lw_float4 axisZ;
} lw_paraboloid;
LW_SIZE_CHECK(lw_paraboloid, 64);

// A record is two 32-bit words: the distance along the texel's centre ray (float bits; infinity where it met
// nothing), and the normal there in the map's frame, turned to the origin: 10 bits a component, n * 511 + 512,
// and this flag; 0, but for the flag below, where it met nothing. Map k's texel (x, y) is record (k * size + y) * size + x.
#define LW_PARABOLOID_HIT 0x40000000u
// Of maps that strict look-ups read: a texel beside this one met something that clearly stands before what this one met.
#define LW_PARABOLOID_DOUBTFUL 0x80000000u

#endif
