// Where technique lpv's grids lie, each within the next one.
#pragma once

#include <memory>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/rsm_input.h"
#include "passes/grid_place.h"
#include "passes/lpv_grid.h"
#include "techniques/technique.h"

namespace lightwell {

class LpvPlaces {
public:
    LpvPlaces(Device& device, const LWLpvDesc& desc);

    void record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement);
    // The places of all grids, as pixels read them: those of record(), or of what is shown, in one table.
    void recordTable(Executor& executor) { places_.recordTable(executor); }
    void recordTable(Executor& executor, std::size_t level, const Buffer& place) { places_.recordTable(executor, level, place); }

    LpvGrid& grid(std::size_t level) { return *grids_[level]; }  // from the finest on
    const LpvGrid& grid(std::size_t level) const { return *grids_[level]; }
    const LpvGrid& coarsest() const { return *grids_.back(); }
    const Buffer& authored() const { return coarsest().authored(); }
    const Buffer& table() const { return places_.table(); }

    LWChoice choice() const { return places_.choice(); }
    void addDebugViews(std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWLpvDesc& desc, const FrameShape& shape);  // without what is injected

private:
    GridPlaces places_;
    std::vector<std::unique_ptr<LpvGrid>> grids_;
};

}  // namespace lightwell
