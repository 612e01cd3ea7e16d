// The word in which a history keeps a surface's normal, the frames in its mean, and whether its noise is known.
#ifndef LW_SURFACE_WORD_H
#define LW_SURFACE_WORD_H

#include "edge_weight.h"

// |size| with the sign of `of`; copysign() goes lane by lane in some drivers.
LW_FN real signed_as(real size, real of) {
    return as_real_((as_lanei_(size) & (lanei)0x7fffffff) | (as_lanei_(of) & (lanei)(int)0x80000000));
}

// Octahedral, 12 bits a coordinate (0.05 degrees), up to 127 frames, and a bit.
LW_FN laneu pack_word(real nx, real ny, real nz, lanei age, mask learnt) {
    const real scale = 1.0f / fmax(fabs(nx) + fabs(ny) + fabs(nz), (real)1e-9f);
    const real u = nx * scale, v = ny * scale;
    const mask below = nz < 0.0f;
    const real fu = select_(u, signed_as(1.0f - fabs(v), u), below), fv = select_(v, signed_as(1.0f - fabs(u), v), below);
    const laneu a = to_laneu(fma_(fu, (real)2047.5f, (real)2048.0f)), b = to_laneu(fma_(fv, (real)2047.5f, (real)2048.0f));
    return a | (b << 12) | (as_laneu_(age) << 24) | (as_laneu_(selecti_((lanei)0, (lanei)1, learnt)) << 31);
}

LW_FN real age_of(laneu word) { return to_real((word >> 24) & (laneu)127); }
LW_FN real learnt_of(laneu word) { return to_real(word >> 31); }

// Cosine between a unit normal and a word's is at least LW_EDGE_NORMAL_COSINE.
LW_FN mask agrees(laneu word, real nx, real ny, real nz) {
    const real u = fma_(to_real(word & (laneu)4095), (real)(1.0f / 2047.5f), (real)-1.0f);
    const real v = fma_(to_real((word >> 12) & (laneu)4095), (real)(1.0f / 2047.5f), (real)-1.0f);
    const real z = 1.0f - fabs(u) - fabs(v), fold = fmax(-z, (real)0.0f);
    const real x = u - signed_as(fold, u), y = v - signed_as(fold, v);
    const real along = fma_(x, nx, fma_(y, ny, z * nz));
    return and_(along > 0.0f, along * along >= LW_EDGE_NORMAL_COSINE * LW_EDGE_NORMAL_COSINE * squared_length(x, y, z));
}

#endif
