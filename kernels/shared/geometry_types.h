// How the host's triangles lie on the device (src/inputs/geometry_input.h).
#ifndef LW_GEOMETRY_TYPES_H
#define LW_GEOMETRY_TYPES_H

// First planes of three: x, y, z or r, g, b.
#define LW_TRIANGLE_A 0
#define LW_TRIANGLE_B 3
#define LW_TRIANGLE_C 6
#define LW_TRIANGLE_ALBEDO 9
#define LW_TRIANGLE_PLANES 12
// Behind these where the host's triangles emit: radiance.
#define LW_TRIANGLE_EMISSION 12
#define LW_TRIANGLE_EMISSIVE_PLANES 15

// The most triangles of a leaf of the tree, neighbours in the order: a multiple of every width.
#define LW_TRIANGLE_GROUP 16

// A tree of boxes over the triangles; node 0 is the root. A node has eight planes of 16 words: its children's centres xyz
// and half their extents xyz, which are negative where there is no child; then where a child's node is, or where the
// triangles of a leaf begin, and how many of these there are, 0 for a node. Children as many as a vector has lanes: one test
// for all.
#define LW_TREE_CHILDREN 16
#define LW_TREE_HALF 48  // first word of the half extents
#define LW_TREE_CHILD 96
#define LW_TREE_COUNT 112
#define LW_TREE_NODE 128  // words
#define LW_TREE_LEVELS 10

#endif
