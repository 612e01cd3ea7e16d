#include "passes/lpv_grid.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/lpv_propagation.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_grid/lpv_grid";
constexpr std::size_t kRun = 64;  // LPV_RUN of the kernels
constexpr Range kListGroup{16, 1};
constexpr Range kCellGroup{16, 4};

std::uint64_t sumBytes(std::uint32_t size) {
    return std::uint64_t(size) * size * size * LW_LPV_PLANES * 2 * sizeof(cl_uint);
}

std::uint64_t texelsOf(const RsmInput& rsms) { return rsms.texels ? rsms.texels.width : 0; }
Range runsOf(std::uint64_t count) { return gridOver(std::size_t((count + kRun - 1) / kRun)); }

}  // namespace

LpvGrid::LpvGrid(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      injectTexels_(device.programs().kernel(kProgram, "lpv_grid_inject_texels")),
      injectVpls_(device.programs().kernel(kProgram, "lpv_grid_inject_vpls")),
      resolve_(device.programs().kernel(kProgram, "lpv_grid_resolve")),
      own_(std::make_unique<GridPlace>(device, size, 1)),
      place_(*own_) {}

LpvGrid::LpvGrid(Device& device, std::uint32_t size, GridPlace& place)
    : device_(device),
      size_(size),
      injectTexels_(device.programs().kernel(kProgram, "lpv_grid_inject_texels")),
      injectVpls_(device.programs().kernel(kProgram, "lpv_grid_inject_vpls")),
      resolve_(device.programs().kernel(kProgram, "lpv_grid_resolve")),
      place_(place) {}

void LpvGrid::recordInject(Executor& executor, const RsmInput& rsms, const Buffer& authored, std::uint32_t authoredCount,
                           const Buffer* inner, const float* environment, const Buffer* changed) {
    const Buffer& left = inner ? *inner : place();  // a kernel's argument must be some memory
    const cl_int hasInner = inner ? 1 : 0;
    sums_.reserve(device_, sumBytes(size_), "sums of injected light");
    if (!injected_) injected_ = LpvPropagation::makeGrid(executor, size_, "injected light");
    executor.fill("lpv_grid.clear", sums_, 0, 0, sums_.bytes());
    const std::uint64_t texels = texelsOf(rsms);
    if (texels)
        executor.run("lpv_grid.inject", injectTexels_, runsOf(texels), kListGroup, rsms.texels, cl_int(texels), place(), left,
                     hasInner, cl_int(size_), sums_, state());
    if (authoredCount)
        executor.run("lpv_grid.inject", injectVpls_, runsOf(authoredCount), kListGroup, authored, cl_int(authoredCount), place(), left,
                     hasInner, cl_int(size_), sums_, state());
    recordResolve(executor, environment, changed);
}

void LpvGrid::recordResolve(Executor& executor, const float* environment, const Buffer* changed) {
    const cl_float4 outside = environment ? cl_float4{{environment[0], environment[1], environment[2], 0.0f}} : cl_float4{};
    executor.run("lpv_grid.resolve", resolve_, {size_, std::size_t(size_) * size_}, kCellGroup, sums_, place(), cl_int(size_),
                 outside, injected_, cl_int(changed ? 1 : 0), changed ? *changed : state());
}

std::uint64_t LpvGrid::bytes() const {
    return (own_ ? own_->bytes() : 0) + sums_.bytes() + injected_.bytes();
}

std::uint64_t LpvGrid::estimateBytes(std::uint32_t size, std::uint32_t authoredCount) {
    return estimatePlaceBytes(authoredCount) + estimateInjectBytes(size);
}

std::uint64_t LpvGrid::estimatePlaceBytes(std::uint32_t authoredCount) { return GridPlace::estimateBytes(authoredCount); }

std::uint64_t LpvGrid::estimateInjectBytes(std::uint32_t size) { return sumBytes(size) + LpvPropagation::gridBytes(size); }

}  // namespace lightwell
