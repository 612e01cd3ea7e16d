// VPLs chosen among candidates by the light that they bring what the frame's source views show, nothing between them
// (resampled importance sampling: Talbot et al. 2005; of VPLs: Georgiev & Slusallek 2010).
// docs/techniques/vpl_view_sampling.md derives it.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/frame_shape.h"
#include "inputs/gbuffer_input.h"
#include "shared/subset_order.h"

namespace lightwell {

class VplViewSampling {
public:
    explicit VplViewSampling(Device& device);

    // Throws what import() would say of this frame's source views.
    static void check(Device& device, const LWFrame& frame);
    // Passes "gbuffer_input.*" and "vpl_view_sampling.points": where the frame's source views look, which share the points
    // evenly. Nothing without views.
    void import(Executor& executor, const LWFrame& frame);
    // Passes "vpl_view_sampling.weigh", ".total" and ".pick", of the points that import() found. candidates: lw_vpl,
    // `candidateCount` of them, drawn by flux: all of one flux, or none. The first `sampleCount` of the order's VPLs are
    // chosen among them, the others are `authored`. offset: of the choice, [0,1).
    void record(Executor& executor, const Buffer& candidates, std::uint32_t candidateCount, std::uint32_t sampleCount,
                float offset, const Buffer& authored, lw_subset_order order, const Buffer& vpls);

    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint64_t candidateCount, const FrameShape& shape);

private:
    Device& device_;
    Kernel &points_, &frameOf_, &weigh_, &total_, &pick_;
    std::vector<GBufferInput> views_;
    Buffer seen_, frame_, weights_;
};

}  // namespace lightwell
