// What the stages of the pass paraboloid_map leave to each other.
#ifndef LW_PARABOLOID_MAP_TYPES_H
#define LW_PARABOLOID_MAP_TYPES_H

#include "portable.h"

// State of a map in this frame, found on the device.
#define LW_MAP_STALE 1  // to be emptied, or written anew
#define LW_MAP_DRAWN 2  // to be drawn as well: its cluster is not empty

// Counters, zero before every frame.
#define LW_MAP_REDRAWN 0  // stale maps
#define LW_MAP_COUNTERS 1

// Columns of the block of texels whose rays a work-item of so many lanes follows: as square as the lanes allow, for a narrow
// frustum.
#define LW_BLOCK_COLUMNS_OF(width) ((width) >= 8 ? 4 : (width) == 4 ? 2 : 1)

// Maps that a work-item draws surfels on, one after the other.
#define LW_MAPS_PER_ITEM 8

#endif
