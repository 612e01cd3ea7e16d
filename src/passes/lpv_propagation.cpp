#include "passes/lpv_propagation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "compute/device.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kCalibrationLayers = 4;

// Vectors of a row, in groups of rows: one local size for each size of grid.
Range groupOf(const Kernel& kernel, std::uint32_t size) {
    const std::size_t vectors = size / kernel.width();
    return {vectors, std::max<std::size_t>(64 / (vectors * kernel.width()), 1)};
}

}  // namespace

LpvPropagation::LpvPropagation(Device& device, std::uint32_t size)
    : size_(size), step_(device.programs().kernel("lpv_propagation/lpv_propagation", "lpv_propagation_step")) {}

std::uint64_t LpvPropagation::gridBytes(std::uint32_t size) {
    return std::uint64_t(LW_LPV_PLANES) * std::uint64_t(lpv_plane(lw_int(size))) * sizeof(float);
}

Buffer LpvPropagation::makeGrid(Executor& executor, std::uint32_t size, const char* what) {
    Buffer grid(executor.device(), gridBytes(size), what);
    executor.fill("lpv_propagation.clear", grid, 0, 0, grid.bytes());
    return grid;
}

const Buffer& LpvPropagation::record(Executor& executor, const Buffer& injected, std::uint32_t steps) {
    for (std::uint32_t i = 0; i < std::min(steps, 2u); ++i)
        if (!grids_[i]) grids_[i] = makeGrid(executor, size_, "propagated light");
    // Colour by colour: three grids of one stay in a cache that three of all would leave.
    const std::uint32_t lines = size_ * size_;
    for (std::uint32_t colour = 0; colour < LW_LPV_COLOURS; ++colour)
        for (std::uint32_t i = 0; i < steps; ++i)
            executor.run("lpv_propagation.step", step_, {size_ / step_.width(), lines}, groupOf(step_, size_), injected,
                         i ? grids_[(i - 1) % 2] : injected, grids_[i % 2], cl_int(size_), cl_int(colour * lines), cl_int(lines));
    return steps ? grids_[(steps - 1) % 2] : injected;
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
