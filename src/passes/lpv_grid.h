// Where a light propagation volume lies, and the light that is injected into it (kernels/lpv_grid).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/rsm_input.h"
#include "shared/lpv_types.h"

namespace lightwell {

// Where a frame's grid shall lie: a cube of this side about a centre, or fitted.
struct LpvPlacement {
    float centre[3] = {0.0f, 0.0f, 0.0f};
    float extent = 0.0f;  // 0: fitted to the surfaces that RSMs see, VPLs with flux, and this box
    bool hasBox = false;
    float low[3] = {0.0f, 0.0f, 0.0f}, high[3] = {0.0f, 0.0f, 0.0f};
    bool refit = false;  // whatever the last frame's grid was
    // What grids lie around that begin at whole cells of the world: with an extent all of them, else those that lie in a fitted one,
    // which without a focus lie in its middle.
    bool hasFocus = false;
    float focus[3] = {0.0f, 0.0f, 0.0f};
};

class LpvGrid {
public:
    LpvGrid(Device& device, std::uint32_t size);

    // Passes "lpv_grid.*". `authored` is read before the call returns. A fitted grid stays as long as the box still fits and
    // is no smaller than three quarters of the grid's inside; then it moves by whole cells, or gets another size.
    void record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                const LpvPlacement& placement, const float* environment = nullptr) {
        recordPlace(executor, rsms, authored, authoredCount, placement);
        recordInject(executor, rsms, authoredCount, environment);
    }
    // Its two halves; the second one where cells shall hold spherical harmonics. environment: radiance of three colours that comes
    // in through the border's cells; none: 0.
    void recordPlace(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                     const LpvPlacement& placement);
    void recordInject(Executor& executor, const RsmInput& rsms, std::uint32_t authoredCount, const float* environment = nullptr) {
        recordInject(executor, rsms, authored_, authoredCount, nullptr, environment);
    }
    // Once more of the last recordInject's sums, with another environment.
    void recordResolve(Executor& executor, const float* environment);
    // In place of recordPlace: with cells half as large as those of `outer`, which it lies in.
    void recordNested(Executor& executor, const LpvGrid& outer, const LpvPlacement& placement);
    // authored: as authored() has them. inner: none, or the place of a grid whose lights are left out.
    void recordInject(Executor& executor, const RsmInput& rsms, const Buffer& authored, std::uint32_t authoredCount,
                      const Buffer* inner, const float* environment = nullptr);

    const Buffer& injected() const { return injected_; }  // a grid of LpvPropagation's
    const Buffer& place() const { return place_; }        // LwLpvPlace
    const Buffer& state() const { return state_; }        // LW_LPV_OUTSIDE: lights that no cell took
    const Buffer& authored() const { return authored_; }  // the last frame's VPLs, as lw_vpl
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t authoredCount);
    static std::uint64_t estimatePlaceBytes(std::uint32_t authoredCount);  // of recordPlace alone
    static std::uint64_t estimateNestedBytes();                            // of recordNested alone
    static std::uint64_t estimateInjectBytes(std::uint32_t size);          // of recordInject alone

private:
    void reservePlace(Executor& executor);

    Device& device_;
    std::uint32_t size_;
    Kernel &scanTexels_, &scanVpls_, &fit_, &nest_, &injectTexels_, &injectVpls_, &resolve_;
    Buffer state_, place_, sums_, injected_, authored_;
};

}  // namespace lightwell
