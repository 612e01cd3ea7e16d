#include "passes/lpv_propagation.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/lpv_plane_layers.h"
#include "passes/lpv_progress.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_propagation/lpv_propagation";

// Of a core's own cache, what the slices between the first and the last step of a wave may take: three grids' of a colour.
// More: they are gone before the next step comes. Less: fewer steps for each way through memory.
constexpr std::size_t kWaveBytes = 1u << 20;
constexpr std::uint32_t kLeastWaveSteps = 2, kMostWaveSteps = 16;

}  // namespace

LpvPropagation::LpvPropagation(Device& device, std::uint32_t size, std::uint32_t units)
    : device_(device),
      size_(size),
      units_(units ? units : device.computeUnits()),
      step_(device.programs().kernel(kProgram, "lpv_propagation_step")),
      wave_(device.programs().kernel(kProgram, "lpv_propagation_wave")) {}

Kernel& LpvPropagation::blocked(const char* kernel) const {
    return device_.programs().kernel("lpv_propagation/lpv_blocked", kernel);
}

std::uint64_t LpvPropagation::gridBytes(std::uint32_t size) {
    return std::uint64_t(LW_LPV_PLANES) * std::uint64_t(lpv_plane(lw_int(size))) * sizeof(float);
}

Buffer LpvPropagation::makeGrid(Executor& executor, std::uint32_t size, const char* what) {
    Buffer grid(executor.device(), gridBytes(size), what);
    executor.fill("lpv_propagation.clear", grid, 0, 0, grid.bytes());
    return grid;
}

const Buffer& LpvPropagation::record(Executor& executor, const Buffer& injected, std::uint32_t steps, const LpvBlockers* blockers,
                                     LpvProgress* progress, const Buffer* rest) {
    if (steps == 0) return injected;
    for (std::uint32_t i = 0; i < std::min(steps, 2u); ++i)
        if (!grids_[i]) grids_[i] = makeGrid(executor, size_, "propagated light");
    const bool inSteps = step_.width() == 1 || steps == 1;
    Run run{injected, blockers, rest, &injected, inSteps ? 1u : 0u};
    const auto take = [&](std::uint32_t count) {
        if (inSteps)
            recordSteps(executor, run, count);
        else
            recordWaves(executor, run, count);
    };
    before_ = &injected;
    if (!progress) {
        take(steps);
        if (steps > 1) before_ = &grids_[1 - run.at];
        return *run.from;
    }
    // All chunks end in the first grid: the host does not know which is the last that is not left out.
    progress->begin(executor);
    run.progress = &progress->state();
    run.at = progress->chunks().front() % 2;
    for (std::size_t chunk = 0; chunk < progress->chunks().size(); ++chunk) {
        take(progress->chunks()[chunk]);
        if (steps > 1) before_ = &grids_[1];
        progress->look(executor, chunk, injected, *before_, grids_[0]);
    }
    return grids_[0];
}

void LpvPropagation::recordSteps(Executor& executor, Run& run, std::uint32_t steps) {
    const std::size_t vectors = size_ / step_.width();
    const Range all{vectors, std::size_t(LW_LPV_COLOURS) * size_ * size_};
    const Range group{vectors, std::min<std::size_t>(size_, std::max<std::size_t>(256 / vectors, 1))};
    const Buffer& progress = run.progress ? *run.progress : run.injected;
    const cl_int watches = run.progress ? 1 : 0;
    for (std::uint32_t i = 0; i < steps; ++i) {
        run.at = 1 - run.at;
        const Buffer& to = grids_[run.at];
        if (run.blockers)
            executor.run("lpv_propagation.step", blocked("lpv_propagation_blocked_step"), all, group, run.injected, *run.from, to,
                         cl_int(size_), run.blockers->faces, run.blockers->runs, progress, watches);
        else
            executor.run("lpv_propagation.step", step_, all, group, run.injected, *run.from, to, cl_int(size_), progress, watches);
        run.from = &to;
    }
}

void LpvPropagation::recordWaves(Executor& executor, Run& run, std::uint32_t steps) {
    // Two work-items for each compute unit, and no more parts than keep two slices a step.
    std::uint32_t parts = 1;
    while (parts * LW_LPV_COLOURS < 2 * units_ && parts * 8 <= size_) parts *= 2;
    const std::size_t sliceBytes = std::size_t(LW_LPV_BANDS) * std::size_t(lpv_slice(lw_int(size_))) * sizeof(float);
    const auto fits = std::uint32_t(kWaveBytes / (3 * sliceBytes));
    const std::uint32_t most = std::min(std::clamp(fits, kLeastWaveSteps, kMostWaveSteps), size_ / (2 * parts));
    const Buffer& progress = run.progress ? *run.progress : run.injected;
    const cl_int watches = run.progress ? 1 : 0;
    for (std::uint32_t left = steps; left > 0;) {
        const std::uint32_t taken = std::min(left, most);
        const Buffer &first = grids_[run.at], &second = grids_[1 - run.at];
        const auto wave = [&](std::uint32_t items, int atCuts) {
            if (run.blockers)
                executor.run("lpv_propagation.wave", blocked("lpv_propagation_blocked_wave"), {items, 1}, {1, 1}, run.injected,
                             *run.from, first, second, cl_int(size_), cl_int(taken), cl_int(parts), cl_int(atCuts),
                             run.blockers->faces, run.blockers->runs, progress, watches);
            else
                executor.run("lpv_propagation.wave", wave_, {items, 1}, {1, 1}, run.injected, *run.from, first, second,
                             cl_int(size_), cl_int(taken), cl_int(parts), cl_int(atCuts), progress, watches);
        };
        wave(LW_LPV_COLOURS * parts, 0);
        if (parts > 1 && taken > 1) wave(LW_LPV_COLOURS * (parts - 1), 1);
        if (taken % 2) run.at = 1 - run.at;
        run.from = &grids_[run.at];
        left -= taken;
    }
}

Planes LpvPropagation::debugPlanes(const Buffer& grid, std::uint32_t size) {
    const lw_int n = lw_int(size);
    Planes planes;
    planes.memory = grid.get();
    planes.offset = lpv_cell(n, 0, 0, 0);
    planes.rowStride = lpv_row(n);
    planes.planeStride = lpv_plane(n);
    planes.width = size;
    planes.height = (size + 2) * size - 2;
    planes.count = LW_LPV_PLANES;
    return planes;
}

std::vector<double> LpvPropagation::calibrations(std::uint32_t size, const std::vector<std::uint32_t>& steps, bool isBlocked) {
    const LpvPlaneLayers injected = LpvPlaneLayers::plane(size);
    LpvPlaneLayers light = injected;
    std::vector<double> result;
    std::uint32_t taken = 0;
    for (const std::uint32_t count : steps) {
        for (; taken < count; ++taken) {
            light = light.stepped(isBlocked);
            light.add(injected);
        }
        result.push_back(light.calibration());
    }
    return result;
}

}  // namespace lightwell
