#include "techniques/lpv_places.h"

namespace lightwell {

LpvPlaces::LpvPlaces(Device& device, const LWLpvDesc& desc) : places_(device, desc.size, 1, desc.cascades) {
    for (std::uint32_t c = 0; c < desc.cascades; ++c)
        grids_.push_back(std::make_unique<LpvGrid>(device, desc.size, places_.grid(c)));
}

void LpvPlaces::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    places_.record(executor, rsms, frame.vpls, frame.vplCount, placement);
}

void LpvPlaces::addDebugViews(std::vector<DebugView>& views) const {
    const Planes planes = places_.debugPlanes();
    if (!planes) return;
    views.push_back({"places", "a row for each grid from the finest on: its lower corner (3), cells to a unit of length, a cell's side, and "
                     "three numbers of its own", planes, {}});
}

std::uint64_t LpvPlaces::bytes() const {
    std::uint64_t total = places_.bytes();
    for (const std::unique_ptr<LpvGrid>& grid : grids_) total += grid->bytes();
    return total;
}

std::uint64_t LpvPlaces::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return GridPlaces::estimateBytes(desc.cascades, shape.vplCount);
}

}  // namespace lightwell
