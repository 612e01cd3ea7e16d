// Surfels (Pfister et al. 2000), small oriented discs that stand for surfaces, as kernels and host share them.
#ifndef LW_SURFEL_TYPES_H
#define LW_SURFEL_TYPES_H

#include "portable.h"

// Planes of the surfels, each padded to whole blocks.
#define LW_SURFEL_POSITION 0
#define LW_SURFEL_NORMAL 3  // unit
#define LW_SURFEL_RADIUS 6  // m; 0: no surfel
#define LW_SURFEL_ALBEDO 7  // a word, see pack_albedo in paraboloid.h
#define LW_SURFEL_PLANES 8
// While a host's own are unpacked: area instead of radius, three planes of albedo.
#define LW_SURFEL_RAW_PLANES 10
// Behind these where they emit: radiance.
#define LW_SURFEL_EMISSION 10
#define LW_SURFEL_EMISSIVE_PLANES 13

// Surfels that a word of candidates speaks of, a bit each: a multiple of every width.
#define LW_SURFEL_BLOCK 32

// Of surfels whose albedo nobody says, as for triangles.
#define LW_UNKNOWN_ALBEDO 0.5f

// Counters beside the surfels. The bounds hold floats whose bits are ordered as whole numbers.
#define LW_SURFEL_REJECTED 0
#define LW_SURFEL_LOWER 1  // x, y, z
#define LW_SURFEL_UPPER 4
#define LW_SURFEL_LARGEST 7  // bits of the largest emission of a colour
#define LW_SURFEL_COUNTERS 8

// What a light sends towards its RSM's texels.
typedef struct {
    lw_float4 emitted;  // E_perp (W/m^2) or intensity (W/sr), rgb
    lw_float4 axis;     // unit; spot lights only
    // A spot light's share of its intensity is clamp(scale * cosine + offset, 0, 1)^2; scale 0, offset 1: all.
    lw_float coneScale, coneOffset;
    lw_float unused[2];
} lw_surfel_light;
LW_SIZE_CHECK(lw_surfel_light, 48);

#endif
