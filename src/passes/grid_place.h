// Where grids of cubic cells lie in a frame, each within the next one (kernels/grid_place).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/rsm_input.h"
#include "passes/world_shift.h"
#include "shared/grid_types.h"

namespace lightwell {

// Where a frame's grid shall lie: a cube of this side about a centre, or fitted.
struct GridPlacement {
    float centre[3] = {0.0f, 0.0f, 0.0f};  // relative to the frame's origin
    float extent = 0.0f;  // 0: fitted to the surfaces that RSMs see, VPLs with flux, and this box
    bool hasBox = false;
    float low[3] = {0.0f, 0.0f, 0.0f}, high[3] = {0.0f, 0.0f, 0.0f};
    bool refit = false;  // whatever the last frame's grid was
    // What grids lie around that begin at whole cells of the world: with an extent all of them, else those that lie in a fitted one,
    // which without a focus lie in its middle.
    bool hasFocus = false;
    float focus[3] = {0.0f, 0.0f, 0.0f};
};

class GridPlace {
public:
    // unit: cells that grids around a focus begin at multiples of; a power of two, size / 4 at most.
    GridPlace(Device& device, std::uint32_t size, std::uint32_t unit);

    // Passes "grid_place.*". `authored` is read before the call returns. A fitted grid stays as long as the box still fits and
    // is no smaller than three quarters of the grid's inside; then it moves by whole cells, or gets another size. Where the origin of
    // positions moves (Executor::worldOrigin), grids stay where they are in the world.
    void record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                const GridPlacement& placement);
    // In its place: with cells half as large as those of `outer`, which it lies in.
    void recordNested(Executor& executor, const GridPlace& outer, const GridPlacement& placement);

    const Buffer& place() const { return place_; }        // LwGridPlace
    const Buffer& state() const { return state_; }        // LW_GRID_STATE
    const Buffer& authored() const { return authored_; }  // record()'s VPLs, as lw_vpl
    std::uint64_t bytes() const { return state_.bytes() + place_.bytes() + authored_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t authoredCount);  // of record()
    static std::uint64_t estimateNestedBytes();                       // of recordNested()

private:
    void reserve(Executor& executor);

    Device& device_;
    std::uint32_t size_, unit_;
    Kernel &scanTexels_, &scanVpls_, &fit_, &nest_;
    Buffer state_, place_, authored_;
    KeptPlaces kept_;  // place_
};

class GridPlaces {
public:
    GridPlaces(Device& device, std::uint32_t size, std::uint32_t unit, std::uint32_t levels);

    void record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                const GridPlacement& placement);
    // The places of all grids, as pixels read them: those of record(), or of what is shown, in one table.
    void recordTable(Executor& executor);
    void recordTable(Executor& executor, std::size_t level, const Buffer& place);

    GridPlace& grid(std::size_t level) { return *grids_[level]; }  // from the finest on
    const GridPlace& grid(std::size_t level) const { return *grids_[level]; }
    const GridPlace& coarsest() const { return *grids_.back(); }
    const Buffer& table() const { return table_; }

    LWChoice choice() const;  // of nested ones
    // A row for each grid from the finest on, as LwGridPlace; without memory before recordTable().
    Planes debugPlanes() const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t levels, std::uint32_t authoredCount);

private:
    Device& device_;
    bool hasFocus_ = false, hasExtent_ = false;  // of the last record()
    std::vector<std::unique_ptr<GridPlace>> grids_;
    Buffer table_;
};

}  // namespace lightwell
