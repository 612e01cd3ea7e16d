// Technique lpv with transport=sweep: the sweep, and the surfaces that stop light and send it on.
#pragma once

#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/geometry_input.h"
#include "inputs/surfel_input.h"
#include "passes/lpv_grid.h"
#include "passes/lpv_sweep.h"
#include "passes/surfel_sampling.h"

namespace lightwell {

class LpvSweepVolume {
public:
    // Throws INVALID_ARGUMENT for a grid that is too large.
    LpvSweepVolume(Device& device, const LWLpvDesc& desc);

    void check(const LWFrame& frame) const;
    // After the grid's place is recorded.
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvGrid& grid, bool restart);
    LpvSweep& sweep() { return sweep_; }
    const LpvSweep& sweep() const { return sweep_; }

    // For twins that prewarm: 1: as if frames had no triangles, 2: neither those nor surfels.
    static constexpr int kSources = 3;
    void hide(int count) { hidden_ = count; }

    // What of the frame's surfaces is used, and what is not. side: of the grid, or less.
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const;
    void report(Report& report) const;
    std::uint64_t bytes() const { return sweep_.bytes() + triangles_.bytes() + surfels_.bytes() + sampling_.bytes(); }
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);

private:
    enum class Source { none, surfels, triangles };
    static Source sourceOf(std::uint32_t surfels, std::uint32_t triangles) {
        return triangles ? Source::triangles : surfels ? Source::surfels : Source::none;
    }
    Source sourceOf(const LWFrame& frame) const {
        if (!frame.geometry) return Source::none;
        return sourceOf(hidden_ > 1 ? 0 : frame.geometry->surfelCount, hidden_ > 0 ? 0 : frame.geometry->triangleCount);
    }

    Device& device_;
    LWLpvDesc desc_;
    Source source_ = Source::none;  // of the last record's surfaces
    int hidden_ = 0;
    GeometryInput triangles_;
    SurfelInput surfels_;
    SurfelSampling sampling_;
    LpvSweep sweep_;
};

}  // namespace lightwell
