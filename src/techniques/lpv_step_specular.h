// Cells for specular rays of technique lpv's grids that light goes from cell to cell in (transport=propagate, coarse_to_fine).
#pragma once

#include <algorithm>

#include "passes/lpv_grid.h"
#include "passes/lpv_specular.h"
#include "techniques/lpv_volume.h"

namespace lightwell {

class LpvStepSpecular {
public:
    LpvStepSpecular(Device& device, std::uint32_t size) : pass_(device, size) {}

    void startFrame(const float* environment) {
        isPacked_ = false;
        std::copy_n(environment, 3, environment_);
    }

    // What surfaces send is what was injected: light on its way through the cells belongs to no surface any more. Nor does the
    // environment's, which border cells send as if they were walls of it: rays that leave the grid bring it, and it would
    // come twice.
    LpvSpecularGrid get(Executor& executor, LpvGrid& grid, const Buffer* corners) {
        if (!isPacked_) {
            const bool hasEnvironment = std::any_of(environment_, environment_ + 3, [](float x) { return x != 0.0f; });
            if (hasEnvironment) grid.recordResolve(executor, nullptr);
            pass_.recordPackSteps(executor, grid.injected(), grid.place(), corners);
            if (hasEnvironment) grid.recordResolve(executor, environment_);  // as debug views show it
            isPacked_ = true;
        }
        return {pass_, grid.place()};
    }

    std::uint64_t bytes() const { return pass_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t size) { return LpvSpecular::estimateBytes(size, false); }

private:
    LpvSpecular pass_;
    bool isPacked_ = false;  // of the last frame
    float environment_[3] = {0.0f, 0.0f, 0.0f};
};

}  // namespace lightwell
