// Technique lpv with transport=propagate: light that goes from cell to cell, and what blocks it between them.
#pragma once

#include <optional>

#include "passes/lpv_progress.h"
#include "passes/lpv_propagation.h"
#include "passes/lpv_read.h"
#include "passes/lpv_rest.h"
#include "techniques/lpv_geometry.h"
#include "techniques/lpv_step_specular.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvStepVolume final : public LpvVolume {
public:
    LpvStepVolume(Device& device, const LWLpvDesc& desc);

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
    // Light crosses a cell in a step at best (Kaplanyan and Dachsbacher 2010 take as many as the grid is long, twice over).
    static std::uint32_t stepsOf(const LWLpvDesc& desc) { return desc.steps ? desc.steps : 2 * desc.size; }

    // With desc.autoError.
    static LpvProgress progressOf(Device& device, const LWLpvDesc& desc);
    // How many were taken is the device's to decide, and to say: added to "steps".
    static void reportProgress(Device& device, const LpvProgress& progress, Report& report);

private:
    Device& device_;
    LWLpvDesc desc_;
    double calibration_;
    LpvGeometry geometry_;
    LpvGrid grid_;
    LpvPropagation propagation_;
    LpvRead read_;
    std::optional<LpvProgress> progress_;  // with an error target
    std::optional<LpvRest> rest_;          // with desc.rests
    bool isWhole_ = false;                 // the last record() came to its end
    LpvStepSpecular specular_;
    const Buffer* propagated_ = nullptr;  // of the last record
};

}  // namespace lightwell
