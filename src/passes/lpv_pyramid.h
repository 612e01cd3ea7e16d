// Propagation on a pyramid of grids, a few steps on each (kernels/lpv_pyramid).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/lpv_propagation.h"

namespace lightwell {

class LpvPyramid {
public:
    // Cells a side of the coarsest grid, the fewest that steps can take.
    static constexpr std::uint32_t kCoarsest = 16;
    static std::uint32_t levelsOf(std::uint32_t size);

    // size: of the finest grid. steps: on each grid; 0: kFewSteps, and on the coarsest, where all that is left must cross the grid and
    // a step costs least, kCoarsestSteps: light spreads by the square root of them, 11 of its 16 cells. Fewer: the far side is dark.
    static constexpr std::uint32_t kFewSteps = 4, kCoarsestSteps = 128;
    LpvPyramid(Device& device, std::uint32_t size, std::uint32_t steps);

    // What blocks in a level's grid, which lies at `place`; 0: the finest.
    using Blockers = std::function<const LpvBlockers*(std::uint32_t level, const Buffer& place)>;
    // Passes "lpv_pyramid.*" and LpvPropagation's. place: the finest grid's. Returns the light of all grids, laid out as that one.
    const Buffer& record(Executor& executor, const Buffer& injected, const Buffer& place, const Blockers& blockers);

    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t steps);
    // As LpvPropagation's, of what all grids bring together.
    static double calibration(std::uint32_t size, std::uint32_t steps, bool isBlocked);
    static std::uint32_t stepsOn(std::uint32_t level, std::uint32_t size, std::uint32_t steps);

private:
    struct Level {
        std::uint32_t size;
        LpvPropagation propagation;
        Buffer place, injected;  // of all but the finest
    };
    Device& device_;
    std::uint32_t steps_;
    Kernel &coarserPlace_, &down_, &up_;
    std::vector<Level> levels_;
};

}  // namespace lightwell
