// Technique lpv with transport=sweep: the sweep, and the surfaces that stop light and send it on.
#pragma once

#include "inputs/geometry_input.h"
#include "inputs/surfel_input.h"
#include "passes/lpv_sweep.h"
#include "passes/surfel_sampling.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvSweepVolume final : public LpvVolume {
public:
    // Throws INVALID_ARGUMENT for a grid that is too large. hidden: 1: as if frames had no triangles, 2: neither those nor surfels.
    LpvSweepVolume(Device& device, const LWLpvDesc& desc, int hidden);

    void check(const LWFrame& frame) const override;
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override {
        sweep_.recordGather(executor, position, normal, irradiance, validity, counts);
    }
    bool hasSpecular() const override { return true; }
    LpvSpecularGrid specular(Executor&) override { return {specular_, sweep_.shownPlace()}; }
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const override;
    void report(Report& report) const override;
    std::uint64_t bytes() const override {
        return grid_.bytes() + sweep_.bytes() + specular_.bytes() + triangles_.bytes() + surfels_.bytes() + sampling_.bytes();
    }
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
    Source source_ = Source::none;  // of the last record's surfaces
    GeometryInput triangles_;
    SurfelInput surfels_;
    SurfelSampling sampling_;
    LpvGrid grid_;  // its place alone
    LpvSweep sweep_;
    LpvSpecular specular_;
};

}  // namespace lightwell
