// VPLs chosen among candidates by the light that they bring what the frame's source views show (resampled importance
// sampling, Talbot et al. 2005; Ritschel et al. 2011). docs/techniques/vpl_view_sampling.md derives it.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/frame_shape.h"
#include "inputs/gbuffer_input.h"
#include "shared/subset_order.h"

namespace lightwell {

class VplViewSampling {
public:
    explicit VplViewSampling(Device& device);

    // Throws what import() would say of this frame's source views.
    static void check(Device& device, const LWFrame& frame);
    // Passes "gbuffer_input.*" and "vpl_view_sampling.points": where the frame's source views look.
    void import(Executor& executor, const LWFrame& frame);
    // Lets go of the frame's images.
    void clear() { views_.clear(); }

    // Passes "vpl_view_sampling.weigh" and ".pick". candidates: lw_vpl, each drawn by flux, `candidateCount` of them. The first
    // `sampleCount` of the order's VPLs are chosen among them, the others are `authored`. offset: of the choice, [0,1).
    void record(Executor& executor, const Buffer& candidates, std::uint32_t candidateCount, std::uint32_t sampleCount,
                float offset, const Buffer& authored, lw_subset_order order, const Buffer& vpls);

    void report(Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint64_t candidateCount, const FrameShape& shape);

private:
    Device& device_;
    Kernel &points_, &frameOf_, &place_, &light_, &gain_, &weigh_, &total_, &pick_;
    std::vector<GBufferInput> views_;
    Buffer seen_, frame_, placed_, parts_, weights_, sums_;
};

}  // namespace lightwell
