// How the host's triangles lie on the device (src/inputs/geometry_input.h).
#ifndef LW_GEOMETRY_TYPES_H
#define LW_GEOMETRY_TYPES_H

// First planes of three: x, y, z or r, g, b.
#define LW_TRIANGLE_A 0
#define LW_TRIANGLE_B 3
#define LW_TRIANGLE_C 6
#define LW_TRIANGLE_ALBEDO 9
#define LW_TRIANGLE_PLANES 12

// Neighbours in the order that are culled at once: a multiple of every width.
#define LW_TRIANGLE_GROUP 16

#endif
