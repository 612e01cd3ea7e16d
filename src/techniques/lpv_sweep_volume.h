// Technique lpv with transport=sweep: the sweep, and the surfaces that stop light and send it on.
#pragma once

#include <optional>

#include "passes/lpv_sweep.h"
#include "techniques/lpv_surfaces.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvSweepVolume final : public LpvVolume {
public:
    // Throws INVALID_ARGUMENT for a grid that is too large. hidden: 1: as if frames had no triangles, 2: neither those nor surfels.
    LpvSweepVolume(Device& device, const LWLpvDesc& desc, int hidden);

    void check(const LWFrame& frame) const override { surfaces_.check(frame); }
    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) override;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts) override {
        sweep_.recordGather(executor, position, normal, irradiance, validity, counts);
    }
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override {
        sweep_.recordHarmonics(executor, position, normal, harmonics, validity, counts);
    }
    bool hasSpecular() const override { return true; }
    LpvSpecularGrid specular(Executor& executor) override {
        if (!isPacked_) specular_.recordPackSweep(executor, sweep_.sources(), false);
        isPacked_ = true;
        specular_.show(executor);
        return {specular_, sweep_.shownPlace()};
    }
    std::vector<LWChoice> choices(const LWFrame& frame, double side) const override { return surfaces_.choices(frame, side); }
    void report(Report& report) const override;
    std::uint64_t bytes() const override {
        return grid_.bytes() + sweep_.bytes() + specular_.bytes() + surfaces_.bytes() + (rest_ ? rest_->bytes() : 0);
    }
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);

    // Throws INVALID_ARGUMENT as well.
    static LpvSweepOptions optionsOf(const LWLpvDesc& desc);

private:
    Device& device_;
    LpvSurfaces surfaces_;
    LpvGrid grid_;  // its place alone
    LpvSweep sweep_;
    LpvSpecular specular_;
    std::optional<LpvRest> rest_;  // with desc.rests
    // One bounce's sources are there when the first view asks; of several, or over frames, they are gone by then.
    bool packsLater_, isPacked_ = false;
};

}  // namespace lightwell
