#include "passes/lpv_propagation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "compute/device.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_propagation/lpv_propagation";
constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kCalibrationLayers = 4;

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

const Buffer& LpvPropagation::record(Executor& executor, const Buffer& injected, std::uint32_t steps, const LpvBlockers* blockers) {
    if (steps == 0) return injected;
    for (std::uint32_t i = 0; i < std::min(steps, 2u); ++i)
        if (!grids_[i]) grids_[i] = makeGrid(executor, size_, "propagated light");
    if (blockers) {
        if (!spread_) spread_ = makeGrid(executor, size_, "injected light, spread once");
        Range group;
        const Range all = rows(group);
        executor.run("lpv_propagation.first", blocked("lpv_propagation_first"), all, group, injected, spread_, cl_int(size_),
                     blockers->faces, blockers->runs);
    }
    const Start start{blockers ? spread_ : injected, injected, blockers};
    return step_.width() == 1 || steps == 1 ? recordSteps(executor, start, steps) : recordWaves(executor, start, steps);
}

Range LpvPropagation::rows(Range& group) const {
    const std::size_t vectors = size_ / step_.width();
    group = {vectors, std::min<std::size_t>(size_, std::max<std::size_t>(256 / vectors, 1))};
    return {vectors, std::size_t(LW_LPV_COLOURS) * size_ * size_};
}

const Buffer& LpvPropagation::recordSteps(Executor& executor, Start start, std::uint32_t steps) {
    Range group;
    const Range all = rows(group);
    const Buffer* from = &start.from;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const Buffer& to = grids_[i % 2];
        if (start.blockers)
            executor.run("lpv_propagation.step", blocked("lpv_propagation_blocked_step"), all, group, start.source, *from,
                         to, cl_int(size_), start.blockers->faces, start.blockers->runs);
        else
            executor.run("lpv_propagation.step", step_, all, group, start.source, *from, to, cl_int(size_));
        from = &to;
    }
    return *from;
}

const Buffer& LpvPropagation::recordWaves(Executor& executor, Start start, std::uint32_t steps) {
    // Two work-items for each compute unit, and no more parts than keep two slices a step.
    std::uint32_t parts = 1;
    while (parts * LW_LPV_COLOURS < 2 * units_ && parts * 8 <= size_) parts *= 2;
    const std::size_t sliceBytes = std::size_t(LW_LPV_BANDS) * std::size_t(lpv_slice(lw_int(size_))) * sizeof(float);
    const auto fits = std::uint32_t(kWaveBytes / (3 * sliceBytes));
    const std::uint32_t most = std::min(std::clamp(fits, kLeastWaveSteps, kMostWaveSteps), size_ / (2 * parts));
    const Buffer* from = &start.from;
    std::uint32_t left = steps, at = 0;
    while (left > 0) {
        const std::uint32_t taken = std::min(left, most);
        const Buffer &first = grids_[at], &second = grids_[1 - at];
        const auto wave = [&](std::uint32_t items, int atCuts) {
            if (start.blockers)
                executor.run("lpv_propagation.wave", blocked("lpv_propagation_blocked_wave"), {items, 1}, {1, 1}, start.source,
                             *from, first, second, cl_int(size_), cl_int(taken), cl_int(parts), cl_int(atCuts),
                             start.blockers->faces, start.blockers->runs);
            else
                executor.run("lpv_propagation.wave", wave_, {items, 1}, {1, 1}, start.source, *from, first, second, cl_int(size_),
                             cl_int(taken), cl_int(parts), cl_int(atCuts));
        };
        wave(LW_LPV_COLOURS * parts, 0);
        if (parts > 1 && taken > 1) wave(LW_LPV_COLOURS * (parts - 1), 1);
        if (taken % 2) at = 1 - at;
        from = &grids_[at];
        left -= taken;
    }
    return *from;
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

// An infinite plane is the same in all of a layer's cells: the step becomes one of layers, c0 and c1 along the plane's normal,
// with four of six neighbours in the layer itself.
double LpvPropagation::calibration(std::uint32_t size, std::uint32_t steps) {
    const double front = LW_LPV_FRONT_ANGLE / kPi, side = LW_LPV_SIDE_ANGLE / kPi, root5 = std::sqrt(5.0);
    const double a = 1.0 / 6.0, b = LW_LPV_LOBE0 * LW_LPV_Y1 * (front + 8.0 / root5 * side);
    const double p = LW_LPV_LOBE1 * LW_LPV_Y0 * front, q = 0.5 * front, k = side / root5;
    const std::size_t layers = size;
    std::vector<double> c0(layers + 2), c1(layers + 2), n0(layers + 2), n1(layers + 2);
    for (std::uint32_t i = 0; i <= steps; ++i) {
        for (std::size_t j = 1; j <= layers; ++j) {
            n0[j] = a * (4.0 * c0[j] + c0[j - 1] + c0[j + 1]) + b * (c1[j - 1] - c1[j + 1]);
            n1[j] = p * (c0[j - 1] - c0[j + 1]) + q * (c1[j - 1] + c1[j + 1]) + 4.0 * k * c1[j];
        }
        n0[1] += LW_LPV_LOBE0 / kPi;  // of the flux of a cell's side, 1
        n1[1] += LW_LPV_LOBE1 / kPi;
        c0.swap(n0);
        c1.swap(n1);
    }
    double sum = 0.0;
    for (std::size_t j = 2; j < 2 + kCalibrationLayers; ++j) sum += LW_LPV_LOBE0 * c0[j] + LW_LPV_LOBE1 * c1[j];
    return sum > 0.0 ? kCalibrationLayers / sum : 0.0;
}

}  // namespace lightwell
