// Light spread step by step through a grid of cells (kernels/lpv_propagation): light propagation volumes, Kaplanyan and
// Dachsbacher 2010.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

// What blocks light between cells: LpvBlocking's.
struct LpvBlockers {
    const Buffer& faces;  // LW_LPV_FACE_PLANES planes, laid out as a grid's
    const Buffer& runs;   // an int for each LW_LPV_BLOCK_RUN cells of a row, by y and z: whether anything blocks there
};

class LpvProgress;

class LpvPropagation {
public:
    // size: cells a side, a power of two from 16 on. units: compute units that the work is cut up for; 0: the device's. The
    // result does not depend on it.
    LpvPropagation(Device& device, std::uint32_t size, std::uint32_t units = 0);

    // Pass "lpv_propagation.wave", or ".step" where work-items hold one cell. `injected`: a grid laid out as
    // shared/lpv_types.h has it. Returns the sum of what was injected and of all that `steps` steps make of it; `injected` itself
    // for none.
    // blockers: none, or what takes light away between cells. progress: none, or when to leave out what is left of its steps,
    // which are as many. rest: without progress; none, or LpvRest's state: where it says so, the last record()'s result stays.
    const Buffer& record(Executor& executor, const Buffer& injected, std::uint32_t steps, const LpvBlockers* blockers = nullptr,
                         LpvProgress* progress = nullptr, const Buffer* rest = nullptr);

    // After record() without `progress`: the sum less what the last step made.
    const Buffer& before() const { return *before_; }

    std::uint64_t bytes() const { return grids_[0].bytes() + grids_[1].bytes(); }
    static std::uint64_t gridBytes(std::uint32_t size);
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t steps) {
        return (steps < 2 ? steps : 2) * gridBytes(size);
    }
    // A grid whose borders are empty, as steps want them.
    static Buffer makeGrid(Executor& executor, std::uint32_t size, const char* what);
    // Planes of a grid for a debug view: slices below each other, with the two empty rows between them.
    static Planes debugPlanes(const Buffer& grid, std::uint32_t size);

    // What irradiance read from the grid is multiplied by: it makes the mean over the four cells above an infinite plane of
    // exitance 1, which fills the grid's lowest layer, 1. No single number does, since the field keeps filling.
    // isBlocked: the plane blocks as well, as what LpvBlocking makes of it does.
    static double calibration(std::uint32_t size, std::uint32_t steps, bool isBlocked = false) {
        return calibrations(size, {steps}, isBlocked).front();
    }
    // The same of several numbers of steps, in ascending order.
    static std::vector<double> calibrations(std::uint32_t size, const std::vector<std::uint32_t>& steps, bool isBlocked);

private:
    // Steps under way: the sum so far, which lies in the grid `at` unless it is what was injected, or will lie there after an
    // even number of steps. progress: none, or LwLpvProgress.
    struct Run {
        const Buffer& injected;
        const LpvBlockers* blockers;
        const Buffer* progress;
        const Buffer* from;
        std::uint32_t at;
    };
    void recordSteps(Executor& executor, Run& run, std::uint32_t steps);
    void recordWaves(Executor& executor, Run& run, std::uint32_t steps);
    Kernel& blocked(const char* kernel) const;  // built when the first frame with blockers asks for it

    Device& device_;
    std::uint32_t size_, units_;
    Kernel &step_, &wave_;
    Buffer grids_[2];
    const Buffer* before_ = nullptr;
};

}  // namespace lightwell
