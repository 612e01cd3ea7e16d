#include "passes/grid_place.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "grid_place/grid_place";
constexpr std::size_t kRun = 64;  // GRID_RUN of the kernels
constexpr Range kListGroup{16, 1};

// So that as many of the largest number do not overflow 63 bits.
cl_int bitsFor(std::uint64_t lights) {
    cl_int bits = 62;
    for (std::uint64_t n = 1; n < lights; n *= 2) --bits;
    return bits;
}

LwGridFit fitOf(const GridPlacement& placement, const WorldStep& step, std::uint32_t size, std::uint32_t unit, std::uint64_t lights) {
    const auto at = [](const float* p, float w) { return cl_float4{{p[0], p[1], p[2], w}}; };
    LwGridFit fit{};
    fit.centre = at(placement.hasFocus ? placement.focus : placement.centre, placement.extent);
    fit.unit = placement.hasFocus ? cl_int(unit) : 0;
    fit.low = at(placement.low, placement.hasBox ? 1.0f : 0.0f);
    fit.high = at(placement.high, 0.0f);
    fit.stepHigh = step.high;
    fit.stepLow = step.low;
    fit.stepLeast = step.least;
    fit.refit = placement.refit ? 1 : 0;
    fit.bits = bitsFor(lights);
    fit.size = cl_int(size);
    return fit;
}

}  // namespace

GridPlace::GridPlace(Device& device, std::uint32_t size, std::uint32_t unit)
    : device_(device),
      size_(size),
      unit_(unit),
      scanTexels_(device.programs().kernel(kProgram, "grid_place_scan_texels")),
      scanVpls_(device.programs().kernel(kProgram, "grid_place_scan_vpls")),
      fit_(device.programs().kernel(kProgram, "grid_place_fit")),
      nest_(device.programs().kernel(kProgram, "grid_place_nest")) {}

void GridPlace::reserve(Executor& executor) {
    state_.reserve(device_, LW_GRID_STATE * sizeof(cl_uint), "bounds of the light");
    if (!place_) {
        place_ = Buffer(device_, sizeof(LwGridPlace), "place of the grid");
        executor.fill("grid_place.clear", place_, 0, 0, place_.bytes());
    }
    executor.fill("grid_place.clear", state_, 0, 0, state_.bytes());
}

void GridPlace::record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                       const GridPlacement& placement) {
    static_assert(sizeof(LWVpl) == sizeof(lw_vpl), "LWVpl is uploaded as it is");
    authored_.reserve(device_, std::max(authoredCount, 1u) * sizeof(lw_vpl), "frame.vpls");
    reserve(executor);
    if (kept_.moves(executor)) kept_.move(executor, place_, {});
    kept_.arrive(executor);
    if (authoredCount) executor.writeCopy("grid_place.upload", authored_, 0, authoredCount * sizeof(lw_vpl), authored);
    const std::uint64_t texels = rsms.texels ? rsms.texels.width : 0;
    if (texels)
        executor.run("grid_place.scan", scanTexels_, gridOver(rsms.rowCount), kListGroup, rsms.texels, rsms.rows,
                     cl_int(rsms.rowCount), state_);
    if (authoredCount)
        executor.run("grid_place.scan", scanVpls_, gridOver((authoredCount + kRun - 1) / kRun), kListGroup, authored_,
                     cl_int(authoredCount), state_);
    executor.run("grid_place.fit", fit_, {1, 1}, {1, 1}, state_, fitOf(placement, worldStep({}, executor.worldOrigin()), size_, unit_, texels + authoredCount), place_);
}

void GridPlace::recordNested(Executor& executor, const GridPlace& outer, const GridPlacement& placement) {
    reserve(executor);
    const WorldStep step = worldStep({}, executor.worldOrigin());
    const cl_float4 focus{{placement.focus[0], placement.focus[1], placement.focus[2], placement.hasFocus ? 1.0f : 0.0f}};
    executor.run("grid_place.fit", nest_, {1, 1}, {1, 1}, outer.place_, focus, step.high, step.low, step.least,
                 cl_int(size_), cl_int(unit_), place_);
}

std::uint64_t GridPlace::estimateBytes(std::uint32_t authoredCount) {
    return estimateNestedBytes() + std::max(authoredCount, 1u) * sizeof(lw_vpl);
}

std::uint64_t GridPlace::estimateNestedBytes() { return LW_GRID_STATE * sizeof(cl_uint) + sizeof(LwGridPlace); }

GridPlaces::GridPlaces(Device& device, std::uint32_t size, std::uint32_t unit, std::uint32_t levels) : device_(device) {
    for (std::uint32_t l = 0; l < levels; ++l) grids_.push_back(std::make_unique<GridPlace>(device, size, unit));
}

void GridPlaces::record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                        const GridPlacement& placement) {
    hasFocus_ = placement.hasFocus;
    hasExtent_ = placement.extent > 0.0f;
    grids_.back()->record(executor, rsms, authored, authoredCount, placement);
    for (std::size_t l = grids_.size() - 1; l-- > 0;) grids_[l]->recordNested(executor, *grids_[l + 1], placement);
}

void GridPlaces::recordTable(Executor& executor) {
    for (std::size_t l = 0; l < grids_.size(); ++l) recordTable(executor, l, grids_[l]->place());
}

void GridPlaces::recordTable(Executor& executor, std::size_t level, const Buffer& place) {
    table_.reserve(device_, grids_.size() * sizeof(LwGridPlace), "places of all grids");
    executor.copy("grid_place.table", place.get(), table_.get(), 0, level * sizeof(LwGridPlace), sizeof(LwGridPlace));
}

LWChoice GridPlaces::choice() const {
    if (hasExtent_)
        return {"cascades", hasFocus_ ? "all grids lie around frame.focus" : "all grids lie around the descriptor's center"};
    return {"cascades", hasFocus_ ? "the coarsest grid is fitted to the scene, finer ones lie around frame.focus"
                                  : "the coarsest grid is fitted to the scene, finer ones lie in its middle, as there is no frame.focus"};
}

Planes GridPlaces::debugPlanes() const {
    Planes planes;
    if (!table_) return planes;
    planes.memory = table_.get();
    planes.rowStride = sizeof(LwGridPlace) / sizeof(float);
    planes.planeStride = std::int64_t(grids_.size()) * planes.rowStride;
    planes.width = std::uint32_t(planes.rowStride);
    planes.height = std::uint32_t(grids_.size());
    planes.count = 1;
    return planes;
}

std::uint64_t GridPlaces::bytes() const {
    std::uint64_t total = table_.bytes();
    for (const std::unique_ptr<GridPlace>& grid : grids_) total += grid->bytes();
    return total;
}

std::uint64_t GridPlaces::estimateBytes(std::uint32_t levels, std::uint32_t authoredCount) {
    return GridPlace::estimateBytes(authoredCount) + (levels - 1) * GridPlace::estimateNestedBytes() + levels * sizeof(LwGridPlace);
}

}  // namespace lightwell
