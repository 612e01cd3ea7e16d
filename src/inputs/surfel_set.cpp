#include "inputs/surfel_set.h"

#include <cstring>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

constexpr std::uint64_t paddedToBlocks(std::uint64_t count) {
    return (count + LW_SURFEL_BLOCK - 1) / LW_SURFEL_BLOCK * LW_SURFEL_BLOCK;
}
// As surfel_input_bounds has it.
constexpr std::uint32_t kBoundsSurfels = 1024;

}  // namespace

std::uint64_t SurfelMemory::estimateBytes(std::uint64_t count, std::uint32_t planeCount) {
    if (count * planeCount > 0x7fffffffu)
        fail(LW_ERROR_UNSUPPORTED, "surfels: ", count, " of them exceed the 32-bit indices of the kernels");
    return (paddedToBlocks(count) * planeCount + LW_SURFEL_COUNTERS + 1) * sizeof(float);
}

void SurfelMemory::reset(Executor& executor, std::uint32_t count, std::uint32_t planeCount) {
    Device& device = executor.device();
    const std::uint64_t padded = paddedToBlocks(count);
    estimateBytes(count, planeCount);  // refuses too many
    if (count) memory_.reserve(device, std::size_t(padded) * planeCount * sizeof(float), "surfels");
    counters_.reserve(device, LW_SURFEL_COUNTERS * sizeof(cl_int), "counters of surfels");
    diagonal_.reserve(device, sizeof(float), "the surfels' extent");
    constexpr std::size_t kBounds = 3 * sizeof(cl_int);
    executor.fill("surfel_input.clear", counters_, 0, 0, sizeof(cl_int));
    executor.fill("surfel_input.clear", counters_, 0, LW_SURFEL_LARGEST * sizeof(cl_int), sizeof(cl_int));
    executor.fill("surfel_input.clear", counters_, 0x7fffffffu, LW_SURFEL_LOWER * sizeof(cl_int), kBounds);
    executor.fill("surfel_input.clear", counters_, 0x80000000u, LW_SURFEL_UPPER * sizeof(cl_int), kBounds);
    count_ = count;
    emits_ = false;
    planes_ = Planes{};
    if (count == 0) return;
    planes_.memory = memory_.get();
    planes_.width = std::uint32_t(padded);
    planes_.rowStride = planes_.planeStride = std::int64_t(padded);
    planes_.height = 1;
    planes_.count = LW_SURFEL_PLANES;
}

void SurfelMemory::measure(Executor& executor) {
    ProgramCache& programs = executor.device().programs();
    Kernel& bounds = programs.kernel("surfel_input/surfel_input", "surfel_input_bounds");
    Kernel& diagonal = programs.kernel("surfel_input/surfel_input", "surfel_input_diagonal");
    if (planes_)
        executor.run("surfel_input.bounds", bounds, {(planes_.width + kBoundsSurfels - 1) / kBoundsSurfels, 1}, {1, 1},
                     planes_.memory, cl_int(planes_.planeStride), counters_);
    executor.run("surfel_input.bounds", diagonal, {1, 1}, {1, 1}, counters_, diagonal_);
}

void SurfelMemory::setDiagonal(Executor& executor, float diagonal) {
    std::uint32_t bits;
    std::memcpy(&bits, &diagonal, sizeof bits);
    executor.fill("surfel_input.bounds", diagonal_, bits, 0, sizeof bits);
}

}  // namespace lightwell
