// Technique lpv with transport=sweep and several grids, each within the next one.
#pragma once

#include <memory>
#include <vector>

#include "passes/lpv_cascades.h"
#include "passes/lpv_sweep.h"
#include "techniques/lpv_places.h"
#include "techniques/lpv_surfaces.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvSweepCascades final : public LpvVolume {
public:
    LpvSweepCascades(Device& device, const LWLpvDesc& desc, int hidden);

    void check(const LWFrame& frame) const override { surfaces_.check(frame); }
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override;
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const override;
    void report(Report& report) const override;
    void addDebugViews(std::vector<DebugView>& views) const override { places_.addDebugViews(views); }
    std::uint64_t bytes() const override;
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);

private:
    void recordPart(Executor& executor, std::size_t level, const LpvSweepInput& input);

    Device& device_;
    LWLpvDesc desc_;
    LpvSurfaces surfaces_;
    LpvPlaces places_;
    LpvCascades cascades_;
    std::vector<std::unique_ptr<LpvSweep>> sweeps_;  // from the finest on
};

}  // namespace lightwell
