// VPLs drawn for pixels instead of dealt out to them, as host and kernels of pass `vpl_resampling` share it.
#ifndef LW_VPL_RESAMPLING_TYPES_H
#define LW_VPL_RESAMPLING_TYPES_H

#include "portable.h"

// Most VPLs that a pixel draws, and keeps of them.
#define LW_MOST_CANDIDATES 64
#define LW_MOST_SURVIVORS 8
// Blocks that a list is cut into: what a tile weighs its VPLs by. More: draws that fit the tile better, in time that grows
// with them for each tile.
#define LW_VPL_BLOCKS 256

typedef struct {
    lw_int slots;       // of the list
    lw_int length;      // slots of a block; the last block may be shorter
    lw_int blocks;      // LW_VPL_BLOCKS at most
    lw_int candidates;  // of a pixel
    lw_int survivors;   // no more than these
    lw_int groups;      // of the list's length, of which a pixel draws from one
    lw_uint key;        // of the random numbers: another one for another seed or frame
    lw_int unused;
} lw_vpl_draws;
LW_SIZE_CHECK(lw_vpl_draws, 32);

// Consecutive slots of a list: those that carry flux.
typedef struct {
    lw_float4 centre;  // m: of the box around them; w: half the box's diagonal
    lw_float4 normal;  // of the box around their normals; w: half its diagonal
    lw_float4 flux;    // x: W, luminance of their flux; yzw unused
} lw_vpl_block;
LW_SIZE_CHECK(lw_vpl_block, 48);

// One that was drawn: its slot, and 1 / (draws of the tile * probability of the slot).
typedef struct {
    lw_int slot;
    float weight;
} lw_vpl_draw;
LW_SIZE_CHECK(lw_vpl_draw, 8);

#endif
