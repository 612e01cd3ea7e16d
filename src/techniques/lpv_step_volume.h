// Technique lpv with transport=propagate: light that goes from cell to cell, and what blocks it between them.
#pragma once

#include <optional>

#include "passes/lpv_propagation.h"
#include "passes/lpv_read.h"
#include "techniques/lpv_geometry.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvStepVolume final : public LpvVolume {
public:
    LpvStepVolume(Device& device, const LWLpvDesc& desc);

    void check(const LWFrame& frame) const override { geometry_.check(frame); }
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override;
    bool hasSpecular() const override { return true; }
    LpvSpecularGrid specular(Executor& executor) override;
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
    LpvPropagation propagation_;
    LpvRead read_;
    LpvSpecular specular_;
    bool isSpecularPacked_ = false;  // of the last record
    const Buffer* propagated_ = nullptr;  // of the last record
};

}  // namespace lightwell
