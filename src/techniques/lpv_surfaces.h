// Technique lpv with transport=sweep: the surfaces that stop light and send it on, from which of the host's inputs.
#pragma once

#include <cstdint>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/geometry_input.h"
#include "inputs/surfel_input.h"
#include "passes/surfel_sampling.h"
#include "techniques/technique.h"

namespace lightwell {

class LpvSurfaces {
public:
    // hidden: 1: as if frames had no triangles, 2: neither those nor surfels.
    LpvSurfaces(Device& device, const LWLpvDesc& desc, int hidden);

    void check(const LWFrame& frame) const;
    // True where nothing that was made of the last frame's surfaces is right any more.
    bool import(Executor& executor, const LWFrame& frame);
    const SurfelSet& surfels() const { return set_; }
    float areaScale() const { return areaScale_; }
    // Of several grids each takes the triangles as they are; none: of one grid, or where there are no triangles. Surfels are what
    // sends light on then, and are drawn for further bounces only.
    const GeometryInput* triangles() const { return source_ == Source::triangles && desc_.cascades > 1 ? &triangles_ : nullptr; }

    // What of the last import's frame was used, and what not. side: of the coarsest grid, or less.
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const;
    void report(Report& report) const;
    std::uint64_t bytes() const { return triangles_.bytes() + surfels_.bytes() + sampling_.bytes(); }
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
    int hidden_;
    Source source_ = Source::none;  // of the last import
    SurfelSet set_;
    float areaScale_ = 1.0f;
    GeometryInput triangles_;
    SurfelInput surfels_;
    SurfelSampling sampling_;
};

}  // namespace lightwell
