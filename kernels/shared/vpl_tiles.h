// Which VPLs a tile of pixels can skip, as the kernels that find out and those that gather share it.
//
// A tile is a rectangle of pixels. For each tile and subset of the VPLs stands one bit per slot, 32 to a
// word; word w of all tiles lie side by side, so that lanes of adjacent tiles load and store together.
#ifndef LW_VPL_TILES_H
#define LW_VPL_TILES_H

#include "portable.h"
#include "subset_order.h"

// Rows of pixels per tile. More: fewer bits to find, but a box that holds more surfaces and skips less.
#define LW_TILE_ROWS 8

typedef struct {
    lw_int columns, rows;  // tiles
    lw_int tileWidth;      // pixels
    lw_int words;          // per subset; 0: nothing is skipped
} lw_vpl_tiles;
LW_SIZE_CHECK(lw_vpl_tiles, 16);

// Tiles of one word or plane, padded.
LW_FN lw_int lw_tile_stride(lw_vpl_tiles tiles) { return (tiles.columns * tiles.rows + 15) & ~15; }

#endif
