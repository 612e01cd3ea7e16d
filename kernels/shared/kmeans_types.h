// What host and kernels of pass `kmeans` share: sizes, and which plane of a buffer holds what.
#ifndef LW_KMEANS_TYPES_H
#define LW_KMEANS_TYPES_H

// Most clusters: which of them have members stands in two words of 32 bits.
#define LW_KMEANS_MOST 64
// Slots whose sums one work-item takes, in order. Fixed, so that sums do not depend on widths and groups: longer chunks
// round more and leave processors idle, shorter ones make more to merge.
#define LW_KMEANS_CHUNK 128
// Slots that the kernels of one work-group take at a time, and clusters or slots of the others' groups.
#define LW_KMEANS_GROUP 64

// Sites: what is clustered, by slot. Positions relative to the VPLs' bounding box, in units of its diagonal; normals as
// they are; then the squared distance to the nearest mean: LW_KMEANS_FAR before there is one, negative for a slot
// without flux, which belongs to no cluster.
#define LW_SITE_DISTANCE 6
#define LW_SITE_PLANES 7

// Means: sites of LW_KMEANS_MOST clusters; what is added to a distance from them, 0 or LW_KMEANS_FAR where there is no
// such cluster; their members' number.
#define LW_MEAN_AWAY 6
#define LW_MEAN_MEMBERS 7
#define LW_MEAN_PLANES 8

// Partials: one chunk's part in LW_KMEANS_MOST clusters. While means are sought: sums of sites, number of members. At the
// end: sums of squared distances, flux and area, the member nearest to the mean and its squared distance.
#define LW_PARTIAL_MEMBERS 6
#define LW_PARTIAL_SPREAD 0
#define LW_PARTIAL_FLUX 1
#define LW_PARTIAL_AREA 4
#define LW_PARTIAL_NEAREST 5
#define LW_PARTIAL_SLOT 6
#define LW_PARTIAL_PLANES 7

// The sites' frame: centre of the box and its diagonal.
#define LW_KMEANS_DIAGONAL 3
#define LW_KMEANS_FRAME 4

// What the squared distance of a cluster's former medoid is multiplied with before the nearest member is sought. A medoid is
// one point light for all its cluster's shadows, and each change of it a jump of those: it stays until another is nearer
// by this much. At 1 shadows jump to and fro between two members about as near; at 0 a cluster keeps a medoid at
// its very rim.
#define LW_MEDOID_STAYS 0.25f

// Beyond every squared distance (weights reach to 1e6), and a quotient by the smallest variate stays finite.
#define LW_KMEANS_FAR 1e30f

#endif
