// A filter that knows how noisy its input is: wide where the paths disagree, none where they agree.
#pragma once

#include <vector>

#include "rival_filter.h"
#include "rival_planes.h"
#include "worker_pool.h"

namespace studio {

class ShrinkFilter {
public:
    // Planes of input(): the mean of a pixel's paths (R, G, B), and noiseOf() its two halves.
    static constexpr int kMeanPlanes = 3, kNoisePlane = 3, kPlanes = 4;
    ShrinkFilter() = default;
    ShrinkFilter(int width, int height);

    PaddedPlanes& input() { return images_[0]; }
    // `windows`: of the levels, finest first; `paths`: of a pixel, both halves. The input is used up;
    // the result has 3 planes.
    const PaddedPlanes& filter(WorkerPool& pool, const TracedSurfaces& surface,
                               const std::vector<std::vector<Tap>>& windows, int paths);
    std::size_t bytes() const;

    // The factor on (mean of the first `a` paths - mean of the other `b`) that makes its variance that
    // of the mean of all.
    static float noiseScale(int a, int b);

private:
    PaddedPlanes images_[2], powers_[2], result_;
};

}  // namespace studio
