#include "techniques/lpv_places.h"

#include "compute/device.h"

namespace lightwell {

LpvPlaces::LpvPlaces(Device& device, const LWLpvDesc& desc) : device_(device), extent_(desc.extent) {
    for (std::uint32_t c = 0; c < desc.cascades; ++c) grids_.push_back(std::make_unique<LpvGrid>(device, desc.size));
}

void LpvPlaces::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    hasFocus_ = placement.hasFocus;
    grids_.back()->recordPlace(executor, rsms, frame.vpls, frame.vplCount, placement);
    for (std::size_t c = grids_.size() - 1; c-- > 0;) grids_[c]->recordNested(executor, *grids_[c + 1], placement);
}

void LpvPlaces::recordTable(Executor& executor) {
    for (std::size_t c = 0; c < grids_.size(); ++c) recordTable(executor, c, grids_[c]->place());
}

void LpvPlaces::recordTable(Executor& executor, std::size_t level, const Buffer& place) {
    table_.reserve(device_, grids_.size() * sizeof(LwLpvPlace), "places of all grids");
    executor.copy("lpv_grid.place", place.get(), table_.get(), 0, level * sizeof(LwLpvPlace), sizeof(LwLpvPlace));
}

LWChoice LpvPlaces::choice() const {
    if (extent_ > 0.0f)
        return {"cascades", hasFocus_ ? "all grids lie around frame.focus" : "all grids lie around the descriptor's center"};
    return {"cascades", hasFocus_ ? "the coarsest grid is fitted to the scene, finer ones lie around frame.focus"
                                  : "the coarsest grid is fitted to the scene, finer ones lie in its middle, as there is no frame.focus"};
}

void LpvPlaces::addDebugViews(std::vector<DebugView>& views) const {
    if (!table_) return;
    Planes planes;
    planes.memory = table_.get();
    planes.rowStride = sizeof(LwLpvPlace) / sizeof(float);
    planes.planeStride = std::int64_t(grids_.size()) * planes.rowStride;
    planes.width = std::uint32_t(planes.rowStride);
    planes.height = std::uint32_t(grids_.size());
    planes.count = 1;
    views.push_back({"places", "a row for each grid from the finest on: its lower corner (3), cells to a unit of length, a cell's side, and "
                     "three numbers of its own", planes, {}});
}

std::uint64_t LpvPlaces::bytes() const {
    std::uint64_t total = table_.bytes();
    for (const std::unique_ptr<LpvGrid>& grid : grids_) total += grid->bytes();
    return total;
}

std::uint64_t LpvPlaces::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvGrid::estimatePlaceBytes(shape.vplCount) + (desc.cascades - 1) * LpvGrid::estimateNestedBytes() +
           desc.cascades * sizeof(LwLpvPlace);
}

}  // namespace lightwell
