#include "passes/lpv_cascades.h"

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_cascades/lpv_cascades";
constexpr Range kCellGroup{16, 4};

}  // namespace

LpvCascades::LpvCascades(Device& device, std::uint32_t size)
    : size_(size),
      addSteps_(device.programs().kernel(kProgram, "lpv_cascades_add_steps")),
      addSweeps_(device.programs().kernel(kProgram, "lpv_cascades_add_sweeps")) {}

void LpvCascades::recordSteps(Executor& executor, const LpvNested& grids, const Buffer& far, const Buffer& cells) {
    executor.run("lpv_cascades.add", addSteps_, {size_, std::size_t(size_) * size_}, kCellGroup, grids.fine, grids.coarse,
                 cl_int(size_), far, cells);
}

void LpvCascades::recordSweeps(Executor& executor, const LpvNested& grids, const Buffer& far, const Buffer& cells,
                               const Buffer* total, const Buffer& largest) {
    executor.run("lpv_cascades.add", addSweeps_, {size_, std::size_t(size_) * size_}, kCellGroup, grids.fine, grids.coarse,
                 cl_int(size_), far, cl_int(total ? 1 : 0), cells, total ? *total : cells, largest);
}

}  // namespace lightwell
