// The rival's edge-aware filter and up-sampling, on the host's vector units.
#pragma once

#include <vector>

#include "gbuffer.h"
#include "rival_planes.h"
#include "worker_pool.h"

namespace studio {

struct Tap {
    int dx = 0, dy = 0;
    float weight = 0.0f;
};
// Window over n x n pixels that holds each place of an n x n pattern with equal weight: half weights at
// its ends, so that it is symmetric.
std::vector<Tap> patternWindow(int n);
// The 5 x 5 B3 spline with `step` pixels between taps (Dammertz et al. 2010).
std::vector<Tap> splineWindow(int step);

// Weighted mean of each plane of `from` (2 to 4) over the taps that lie on the pixel's own surface; no tap
// reaches farther than PaddedPlanes::kPad sideways.
void filterImage(WorkerPool& pool, const TracedSurfaces& surface, const std::vector<Tap>& taps,
                 const PaddedPlanes& from, PaddedPlanes& to);

struct PixelPlace {
    int x = 0, y = 0;
};
// `from` has one pixel for each block of factor x factor pixels (2, 4). Bilinear over those on the
// pixel's own surface; pixels without any are left black and listed, top row first.
std::vector<PixelPlace> upsampleImage(WorkerPool& pool, int factor, const TracedSurfaces& coarse,
                                      const PaddedPlanes& from, const GBuffer& fine, PlanarBuffer& to);

}  // namespace studio
