// What the stages of the pass paraboloid_map leave to each other.
#ifndef LW_PARABOLOID_MAP_TYPES_H
#define LW_PARABOLOID_MAP_TYPES_H

#include "portable.h"

// State of a map in this frame, found on the device.
#define LW_MAP_STALE 1  // to be cleared and resolved
#define LW_MAP_DRAWN 2  // to be drawn as well: its cluster is not empty

// Counters, zero before every frame.
#define LW_MAP_LARGE 0      // triangles put into the list of large ones, also those that found no room
#define LW_MAP_INLINE 1     // those without room, drawn where they were found
#define LW_MAP_REDRAWN 2    // stale maps
#define LW_MAP_COUNTERS 3

// Maps that a work-item draws, one after the other.
#define LW_MAPS_PER_ITEM 8

// A triangle on one map that covers so many texels that its rows of tiles are shared among work-items.
typedef struct {
    lw_int map, triangle;
    lw_int columns, rows;  // of tiles: first and, 16 bits up, last
    lw_uint reached;       // rows of tiles, a bit each, in which the first sweep reached a texel
    lw_uint unused[3];
} lw_large_triangle;
LW_SIZE_CHECK(lw_large_triangle, 32);

#endif
