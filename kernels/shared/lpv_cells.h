// How lights find their cell of a light propagation volume, and how they become whole numbers.
#ifndef LW_LPV_CELLS_H
#define LW_LPV_CELLS_H

#include "lpv_types.h"

// The cell of the point `shift` cells along the normal, or -1.
LW_FN int cell_of(const LwLpvPlace place, int size, float px, float py, float pz, float nx, float ny, float nz, float shift) {
    const float inverse = place.origin.w, most = (float)size;
    const float x = (px - place.origin.x) * inverse + shift * nx, y = (py - place.origin.y) * inverse + shift * ny,
                z = (pz - place.origin.z) * inverse + shift * nz;
    if (!(inverse > 0.0f && x >= 0.0f && x < most && y >= 0.0f && y < most && z >= 0.0f && z < most)) return -1;
    return ((int)z * size + (int)y) * size + (int)x;
}

// Towards zero: rounding to the nearest takes PoCL a hundred times as long.
LW_FN long whole(float light, const LwLpvPlace place) { return (long)(light * place.cell.y * place.cell.z); }

#endif
