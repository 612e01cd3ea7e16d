// What technique lpv carries a frame's light through, and reads it from.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/frame_shape.h"
#include "inputs/rsm_input.h"
#include "passes/lpv_grid.h"
#include "passes/lpv_specular.h"
#include "techniques/technique.h"

namespace lightwell {

// Cells that specular rays march through, and where they lie.
struct LpvSpecularGrid {
    LpvSpecular& pass;
    const Buffer& place;  // LwLpvPlace
};

class LpvVolume {
public:
    virtual ~LpvVolume() = default;

    // Throws what record() would say of this frame, whose RSMs are RsmInput's to check.
    virtual void check(const LWFrame& frame) const = 0;
    // Light of RSMs and authored VPLs through the grid, and what blocks it.
    virtual void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) = 0;
    // After record(), as LpvRead::recordGather describes it.
    virtual void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                              const Planes& validity, const Buffer& counts) = 0;

    // Of the last record(), packed when first asked for; only of volumes that have them.
    virtual bool hasSpecular() const { return false; }
    virtual LpvSpecularGrid specular(Executor&) { fail(LW_ERROR_INTERNAL, "lpv: expected a volume with specular cells, got another"); }

    // What of the last record's frame was used, and what not. side: of the grid, or less.
    virtual std::vector<LWChoice> choices(const LWFrame& frame, double side) const = 0;
    virtual void report(Report& report) const = 0;
    virtual void addDebugViews(std::vector<DebugView>&) const {}
    virtual std::uint64_t bytes() const = 0;
};

// Of desc.transport. hidden: for twins that prewarm, so many kinds of blockers are taken to be absent from frames, the best first;
// one of kLpvBlockerKinds - 1 at most.
constexpr int kLpvBlockerKinds = 3;
std::unique_ptr<LpvVolume> makeLpvVolume(Device& device, const LWLpvDesc& desc, int hidden = 0);
std::uint64_t estimateLpvVolumeBytes(const LWLpvDesc& desc, const FrameShape& shape);

}  // namespace lightwell
