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

// What groups of view points see, by the map of the point in each one's middle.
struct ViewSights {
    const Buffer& assignment;  // int by point: its group, or -1
    std::uint32_t groups;
    const Buffer &frames, &records;  // as ParaboloidMap has them
    std::uint32_t size;
};

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
                float offset, const Buffer& authored, lw_subset_order order, const Buffer& vpls, const ViewSights* sights);

    // The view points as VPLs of equal flux, for a k-means; without a surface: none.
    const Buffer& points() const { return list_; }
    static std::uint32_t pointCount();

    void report(Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint64_t candidateCount, const FrameShape& shape);

private:
    Device& device_;
    Kernel &points_, &frameOf_, &place_, &light_, &gain_, &weigh_, &total_, &pick_, &candidates_;
    Kernel* look_ = nullptr;
    std::vector<GBufferInput> views_;
    Buffer seen_, frame_, placed_, list_, parts_, planes_, sights_, weights_, sums_;
};

}  // namespace lightwell
