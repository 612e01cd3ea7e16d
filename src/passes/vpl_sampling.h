// Virtual point lights drawn from reflective shadow maps (Dachsbacher & Stamminger 2005), in the order
// that an interleaved gather walks them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/rsm_input.h"
#include "passes/vpl_list.h"
#include "passes/vpl_view_sampling.h"
#include "shared/subset_order.h"
#include "shared/vpl_types.h"

namespace lightwell {

struct VplSamplingOptions {
    std::uint32_t count = 256;     // drawn from the texels; 0: every texel is a VPL
    bool uniform = false;          // over texels, instead of by reflected flux
    bool view = false;             // by what they bring the frame's source views, of several times as many by flux
    std::uint32_t subsets = 16;    // of the gather
    std::uint32_t seed = 0;        // Cranley-Patterson rotation; 0: none
};

// What another pass has to say about how many are drawn: it is called once the texels are summed up, and
// leaves an int, from 1 to `count`, in the memory. The others of the list then carry no flux.
struct VplPlan {
    const Buffer& live;
    std::function<void(const Buffer& texelSums, const Buffer& rowTotals)> choose;
};

class VplSampling {
public:
    VplSampling(Device& device, const VplSamplingOptions& options);

    // With options.view: the views that the next record() draws for. Other options read none.
    void check(const LWFrame& frame) const;
    void importViews(Executor& executor, const LWFrame& frame);

    // Records passes "vpl_sampling.*". `authored`: the host's own VPLs, appended to those drawn; read
    // before the call returns. `plan`: not asked where none are drawn.
    void record(Executor& executor, const RsmInput& rsms, const LWVpl* authored,
                std::uint32_t authoredCount, const VplPlan* plan = nullptr);

    // The sample set's `number`-th shift from the seed's: those of a row of frames lie as far apart as they can. 0: none.
    void turn(std::uint32_t number) { turns_ = number; }

    const Buffer& vpls() const { return vpls_; }         // lw_vpl by slot
    lw_subset_order order() const { return order_; }
    std::uint32_t vplCount() const { return std::uint32_t(order_.count); }
    // Of a list of VPLs, its own or another pass's. Planes without memory: position, normal, flux, area by slot; and what fills
    // them.
    static Planes debugShape(lw_subset_order order);
    void recordPlanes(Executor& executor, const Buffer& vpls, const Planes& planes);
    std::uint64_t bytes() const;
    // What frames of this shape will have.
    static lw_subset_order orderOf(const VplSamplingOptions& options, const FrameShape& shape);
    static std::uint64_t estimateBytes(const VplSamplingOptions& options, const FrameShape& shape);

private:
    void reserve(const RsmInput& rsms, std::uint32_t authoredCount);
    void sumUp(Executor& executor, const RsmInput& rsms);
    void draw(Executor& executor, const RsmInput& rsms, std::uint32_t sampleCount, const VplPlan* plan);
    void choose(Executor& executor, const RsmInput& rsms, std::uint32_t sampleCount);

    Device& device_;
    VplSamplingOptions options_;
    std::uint32_t turns_ = 0;
    Kernel &rowSums_, &total_, &draw_, &drawLive_, &all_, &planes_;
    std::uint64_t summed_ = 0;  // the generation of the texels whose sums these are
    Buffer texelSums_, rowTotals_, rowSumsBuffer_, authored_, vpls_, candidates_;
    std::optional<VplViewSampling> views_;  // with options.view only
    lw_subset_order order_{};
};

}  // namespace lightwell
