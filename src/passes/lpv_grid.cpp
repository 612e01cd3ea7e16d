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

// So that as many of the largest number do not overflow 63 bits; no coefficient is above a third of its flux.
cl_int bitsFor(std::uint64_t lights) {
    cl_int bits = 62;
    for (std::uint64_t n = 1; n < lights; n *= 2) --bits;
    return bits;
}

std::uint64_t texelsOf(const RsmInput& rsms) { return rsms.texels ? rsms.texels.width : 0; }
Range runsOf(std::uint64_t count) { return gridOver(std::size_t((count + kRun - 1) / kRun)); }

LwLpvFit fitOf(const LpvPlacement& placement, std::uint32_t size, std::uint64_t lights) {
    const auto at = [](const float* p, float w) { return cl_float4{{p[0], p[1], p[2], w}}; };
    LwLpvFit fit{};
    fit.centre = at(placement.hasFocus ? placement.focus : placement.centre, placement.extent);
    fit.snaps = placement.hasFocus ? 1 : 0;
    fit.low = at(placement.low, placement.hasBox ? 1.0f : 0.0f);
    fit.high = at(placement.high, 0.0f);
    fit.refit = placement.refit ? 1 : 0;
    fit.bits = bitsFor(lights);
    fit.size = cl_int(size);
    return fit;
}

}  // namespace

LpvGrid::LpvGrid(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      scanTexels_(device.programs().kernel(kProgram, "lpv_grid_scan_texels")),
      scanVpls_(device.programs().kernel(kProgram, "lpv_grid_scan_vpls")),
      fit_(device.programs().kernel(kProgram, "lpv_grid_fit")),
      nest_(device.programs().kernel(kProgram, "lpv_grid_nest")),
      injectTexels_(device.programs().kernel(kProgram, "lpv_grid_inject_texels")),
      injectVpls_(device.programs().kernel(kProgram, "lpv_grid_inject_vpls")),
      resolve_(device.programs().kernel(kProgram, "lpv_grid_resolve")) {}

void LpvGrid::reservePlace(Executor& executor) {
    state_.reserve(device_, LW_LPV_STATE * sizeof(cl_uint), "bounds of the light");
    if (!place_) {
        place_ = Buffer(device_, sizeof(LwLpvPlace), "place of the grid");
        executor.fill("lpv_grid.clear", place_, 0, 0, place_.bytes());
    }
    executor.fill("lpv_grid.clear", state_, 0, 0, state_.bytes());
}

void LpvGrid::recordPlace(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                          const LpvPlacement& placement) {
    static_assert(sizeof(LWVpl) == sizeof(lw_vpl), "LWVpl is uploaded as it is");
    authored_.reserve(device_, std::max(authoredCount, 1u) * sizeof(lw_vpl), "frame.vpls");
    reservePlace(executor);
    if (authoredCount) executor.writeCopy("lpv_grid.upload", authored_, 0, authoredCount * sizeof(lw_vpl), authored);
    const std::uint64_t texels = texelsOf(rsms);
    if (texels)
        executor.run("lpv_grid.scan", scanTexels_, gridOver(rsms.rowCount), kListGroup, rsms.texels, rsms.rows,
                     cl_int(rsms.rowCount), state_);
    if (authoredCount)
        executor.run("lpv_grid.scan", scanVpls_, runsOf(authoredCount), kListGroup, authored_, cl_int(authoredCount), state_);
    executor.run("lpv_grid.fit", fit_, {1, 1}, {1, 1}, state_, fitOf(placement, size_, texels + authoredCount), place_);
}

void LpvGrid::recordNested(Executor& executor, const LpvGrid& outer, const LpvPlacement& placement) {
    reservePlace(executor);
    const cl_float4 focus{{placement.focus[0], placement.focus[1], placement.focus[2], placement.hasFocus ? 1.0f : 0.0f}};
    executor.run("lpv_grid.fit", nest_, {1, 1}, {1, 1}, outer.place_, focus, cl_int(size_), place_);
}

void LpvGrid::recordInject(Executor& executor, const RsmInput& rsms, const Buffer& authored, std::uint32_t authoredCount,
                           const Buffer* inner, const float* environment) {
    const Buffer& left = inner ? *inner : place_;  // a kernel's argument must be some memory
    const cl_int hasInner = inner ? 1 : 0;
    sums_.reserve(device_, sumBytes(size_), "sums of injected light");
    if (!injected_) injected_ = LpvPropagation::makeGrid(executor, size_, "injected light");
    executor.fill("lpv_grid.clear", sums_, 0, 0, sums_.bytes());
    const std::uint64_t texels = texelsOf(rsms);
    if (texels)
        executor.run("lpv_grid.inject", injectTexels_, runsOf(texels), kListGroup, rsms.texels, cl_int(texels), place_, left,
                     hasInner, cl_int(size_), sums_, state_);
    if (authoredCount)
        executor.run("lpv_grid.inject", injectVpls_, runsOf(authoredCount), kListGroup, authored, cl_int(authoredCount), place_, left,
                     hasInner, cl_int(size_), sums_, state_);
    recordResolve(executor, environment);
}

void LpvGrid::recordResolve(Executor& executor, const float* environment) {
    const cl_float4 outside = environment ? cl_float4{{environment[0], environment[1], environment[2], 0.0f}} : cl_float4{};
    executor.run("lpv_grid.resolve", resolve_, {size_, std::size_t(size_) * size_}, kCellGroup, sums_, place_, cl_int(size_),
                 outside, injected_);
}

std::uint64_t LpvGrid::bytes() const {
    return state_.bytes() + place_.bytes() + sums_.bytes() + injected_.bytes() + authored_.bytes();
}

std::uint64_t LpvGrid::estimateBytes(std::uint32_t size, std::uint32_t authoredCount) {
    return estimatePlaceBytes(authoredCount) + estimateInjectBytes(size);
}

std::uint64_t LpvGrid::estimatePlaceBytes(std::uint32_t authoredCount) {
    return estimateNestedBytes() + std::max(authoredCount, 1u) * sizeof(lw_vpl);
}

std::uint64_t LpvGrid::estimateNestedBytes() { return LW_LPV_STATE * sizeof(cl_uint) + sizeof(LwLpvPlace); }

std::uint64_t LpvGrid::estimateInjectBytes(std::uint32_t size) { return sumBytes(size) + LpvPropagation::gridBytes(size); }

}  // namespace lightwell
