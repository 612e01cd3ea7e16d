// Technique lpv with transport=propagate and several grids, each within the next one.
#pragma once

#include <memory>
#include <vector>

#include "passes/lpv_cascades.h"
#include "passes/lpv_propagation.h"
#include "passes/lpv_read.h"
#include "techniques/lpv_geometry.h"
#include "techniques/lpv_places.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvStepCascades final : public LpvVolume {
public:
    LpvStepCascades(Device& device, const LWLpvDesc& desc);

    void check(const LWFrame& frame) const override { geometry_.check(frame); }
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override;
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const override;
    void report(Report& report) const override;
    void addDebugViews(std::vector<DebugView>& views) const override;
    std::uint64_t bytes() const override;
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);

private:
    // Of one grid, from the finest on.
    struct Level {
        Level(Device& device, std::uint32_t size) : propagation(device, size), all(device, size), outer(device, size) {}
        LpvPropagation propagation;
        LpvRead all, outer;                  // cells of all lights' light, of that of lights outside of the finer grid
        const Buffer* propagated = nullptr;  // of the last record
    };
    void recordField(Executor& executor, const LWFrame& frame, const RsmInput& rsms, std::size_t level, bool isOuter,
                     const LpvBlockers* blockers);

    Device& device_;
    LWLpvDesc desc_;
    double calibration_;
    LpvGeometry geometry_;
    LpvPlaces places_;
    LpvCascades cascades_;
    std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace lightwell
