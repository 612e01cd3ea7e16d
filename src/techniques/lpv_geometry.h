// Technique lpv's geometry volume: what blocks, from which of the host's inputs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/screen_surfels.h"
#include "inputs/surfel_input.h"
#include "passes/lpv_blocking.h"
#include "passes/surfel_sampling.h"
#include "techniques/technique.h"

namespace lightwell {

class LpvGeometry {
public:
    // Where a frame's blockers come from.
    enum class Source { none, triangles, surfels, screen };

    // levels: of grids, each with half as many cells a side as the one before, that light is blocked in.
    LpvGeometry(Device& device, const LWLpvDesc& desc, std::uint32_t levels = 1);

    // Throws what import() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame) const;
    void import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    // After commands failed on the device: the next import() and record() do all anew.
    void forget();
    // What blocks in a grid that lies at `place`, of cascades or levels from the finest on; none where the parameter is off.
    std::optional<LpvBlockers> record(Executor& executor, const Buffer& place, std::size_t grid = 0);

    // LpvBlocking's, of the last record(); null where the parameter is off.
    const Buffer* corners() const { return blockings_.empty() ? nullptr : &blockings_.front()->corners(); }

    // LwLpvBlockers of the same; null where the parameter is off.
    const Buffer* state() const { return blockings_.empty() ? nullptr : &blockings_.front()->state(); }

    // What of the frame's geometry and views is used, and what is not.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape, std::uint32_t levels = 1);

private:
    void forgetBlockers();
    Source sourceOf(const LWFrame& frame) const;
    void importScreen(Executor& executor, const LWFrame& frame, const RsmInput& rsms);

    Device& device_;
    LWLpvDesc desc_;
    Source source_ = Source::none;
    GeometryInput triangles_;
    SurfelInput hostSurfels_;
    ScreenSurfels screen_;
    std::optional<SurfelSampling> sampling_;
    std::vector<std::unique_ptr<LpvBlocking>> blockings_;  // of each grid; none where the parameter is off
    std::vector<SurfelRange> views_;  // of what the screen shows
};

}  // namespace lightwell
