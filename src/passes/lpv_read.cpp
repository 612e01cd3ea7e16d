#include "passes/lpv_read.h"

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_read/lpv_read";
constexpr Range kCellGroup{16, 4};
constexpr std::uint64_t kCellFloats = 16;  // LPV_CELL_FLOATS of the kernels

}  // namespace

LpvRead::LpvRead(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      pack_(device.programs().kernel(kProgram, "lpv_read_pack")),
      gather_(device.programs().kernel(kProgram, "lpv_read_gather")),
      harmonics_(device.programs().kernel(kProgram, "lpv_read_harmonics")) {}

void LpvRead::recordPack(Executor& executor, const Buffer& grid, const Buffer* progress) {
    cells_.reserve(device_, estimateBytes(size_), "cells of the grid");
    executor.run("lpv_read.pack", pack_, {size_, std::size_t(size_) * size_}, kCellGroup, grid, cl_int(size_),
                 progress ? *progress : grid, cl_int(progress ? 1 : 0), cells_);
}

void LpvRead::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& place,
                           double calibration, bool isDamped, const Planes& irradiance, const Planes& validity,
                           const Buffer& counts, LpvLayer layer) {
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const Range items{(position.width + gather_.width() - 1) / gather_.width(), position.height};
    executor.run("lpv_read.gather", gather_, items, gather_.width() == 1 ? Range{64, 1} : Range{8, 1}, position, normal,
                 cl_int(position.width), cl_int(position.height), place, cl_int(layer.index), cl_int(layer.count),
                 cl_int(size_), cells_, cl_float(calibration),
                 cl_int(isDamped ? 1 : 0), cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0), orElse(irradiance), orElse(validity), counts);
}

void LpvRead::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Buffer& place,
                              double calibration, const Harmonics& harmonics, const Planes& validity, const Buffer& counts, LpvLayer layer) {
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const Range items{(position.width + harmonics_.width() - 1) / harmonics_.width(), position.height};
    executor.run("lpv_read.harmonics", harmonics_, items, harmonics_.width() == 1 ? Range{64, 1} : Range{8, 1}, position,
                 orElse(normal), cl_int(normal ? 1 : 0), cl_int(position.width), cl_int(position.height), place, cl_int(layer.index),
                 cl_int(layer.count), cl_int(size_), cells_, cl_float(calibration), cl_int(harmonics ? 1 : 0), cl_int(validity ? 1 : 0), orElse(harmonics.first), harmonics.band,
                 orElse(validity), counts);
}

std::uint64_t LpvRead::estimateBytes(std::uint32_t size) {
    return std::uint64_t(size) * size * size * kCellFloats * sizeof(float);
}

}  // namespace lightwell
