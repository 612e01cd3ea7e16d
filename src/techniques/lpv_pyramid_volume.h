// Technique lpv with transport=coarse_to_fine: light that goes from cell to cell, on a pyramid of grids.
#pragma once

#include "passes/lpv_pyramid.h"
#include "passes/lpv_read.h"
#include "techniques/lpv_geometry.h"
#include "techniques/lpv_step_specular.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvPyramidVolume final : public LpvVolume {
public:
    LpvPyramidVolume(Device& device, const LWLpvDesc& desc);

    void check(const LWFrame& frame) const override { geometry_.check(frame); }
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override;
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override;
    bool hasSpecular() const override { return true; }
    LpvSpecularGrid specular(Executor& executor) override { return specular_.get(executor, grid_, geometry_.corners()); }
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const override;
    void report(Report& report) const override;
    void addDebugViews(std::vector<DebugView>& views) const override;
    std::uint64_t bytes() const override;
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);

private:
    Device& device_;
    LWLpvDesc desc_;
    double calibration_;
    LpvGeometry geometry_;
    LpvGrid grid_;
    LpvPyramid pyramid_;
    LpvRead read_;
    LpvStepSpecular specular_;
    const Buffer* propagated_ = nullptr;  // of the last record
};

}  // namespace lightwell
