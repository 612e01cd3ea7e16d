// The light that is injected into a light propagation volume (kernels/lpv_grid), and where it lies (pass grid_place).
#pragma once

#include <cstdint>
#include <memory>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/rsm_input.h"
#include "passes/grid_place.h"
#include "shared/lpv_types.h"

namespace lightwell {

using LpvPlacement = GridPlacement;

class LpvGrid {
public:
    LpvGrid(Device& device, std::uint32_t size);                    // with a place of its own
    LpvGrid(Device& device, std::uint32_t size, GridPlace& place);  // at one that others record and count

    // Passes "grid_place.*" and "lpv_grid.*". `authored` is read before the call returns.
    void record(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                const LpvPlacement& placement, const float* environment = nullptr, const Buffer* changed = nullptr) {
        recordPlace(executor, rsms, authored, authoredCount, placement);
        recordInject(executor, rsms, place_.authored(), authoredCount, nullptr, environment, changed);
    }
    // Its two halves; the second one where cells shall hold spherical harmonics. environment: radiance of three colours that comes
    // in through the border's cells; none: 0.
    void recordPlace(Executor& executor, const RsmInput& rsms, const LWVpl* authored, std::uint32_t authoredCount,
                     const LpvPlacement& placement) {
        place_.record(executor, rsms, authored, authoredCount, placement);
    }
    void recordInject(Executor& executor, const RsmInput& rsms, std::uint32_t authoredCount, const float* environment = nullptr) {
        recordInject(executor, rsms, place_.authored(), authoredCount, nullptr, environment);
    }
    // Once more of the last recordInject's sums, with another environment.
    void recordResolve(Executor& executor, const float* environment, const Buffer* changed = nullptr);
    // In place of recordPlace: with cells half as large as those of `outer`, which it lies in.
    void recordNested(Executor& executor, const LpvGrid& outer, const LpvPlacement& placement) {
        place_.recordNested(executor, outer.place_, placement);
    }
    // authored: as authored() has them. inner: none, or the place of a grid whose lights are left out. changed: none, or an int that is
    // raised where injected() becomes other than it was.
    void recordInject(Executor& executor, const RsmInput& rsms, const Buffer& authored, std::uint32_t authoredCount,
                      const Buffer* inner, const float* environment = nullptr, const Buffer* changed = nullptr);

    const Buffer& injected() const { return injected_; }          // a grid of LpvPropagation's
    const Buffer& place() const { return place_.place(); }        // LwLpvPlace
    const Buffer& state() const { return place_.state(); }        // LW_LPV_OUTSIDE: lights that no cell took
    const Buffer& authored() const { return place_.authored(); }  // the last frame's VPLs, as lw_vpl
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t authoredCount);
    static std::uint64_t estimatePlaceBytes(std::uint32_t authoredCount);  // of recordPlace alone
    static std::uint64_t estimateInjectBytes(std::uint32_t size);          // of recordInject alone

private:
    Device& device_;
    std::uint32_t size_;
    Kernel &injectTexels_, &injectVpls_, &resolve_;
    std::unique_ptr<GridPlace> own_;
    GridPlace& place_;
    Buffer sums_, injected_;
};

}  // namespace lightwell
