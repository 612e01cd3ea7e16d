// Cheap figures of a frame from which the planner predicts how wrong a technique will be: light that a few emitters bring to a
// grid of pixels, what the view shows of it and of itself. docs/planner.md defines each.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/late_read.h"
#include "inputs/rsm_input.h"
#include "lightwell/lightwell.h"
#include "passes/frame_figures.h"
#include "shared/frame_probes_types.h"
#include "shared/screen_types.h"

namespace lightwell {

// The view that is probed.
struct ProbedView {
    Planes position, normal;
    Planes albedo, directRadiance;  // may be none
    std::uint32_t width = 0, height = 0;
    bool hasCamera = false;
    LwScreenCamera camera{};  // of pixels
};

class FrameProbes {
public:
    explicit FrameProbes(Device& device);

    // Records passes "frame_probes.*". `vpls`: the host's own, read before the call returns.
    void record(Executor& executor, const ProbedView& view, const RsmInput& rsms, const LWVpl* vpls, std::uint32_t vplCount);
    // Has them read once what is enqueued so far has run; while a read is under way, none other begins.
    void readLate(Executor& executor);
    bool isReading() const { return late_.isPending(); }
    // What has come since the last call; null where nothing has, or commands failed.
    const FrameFigures* take();

    const Buffer& sums() const { return probes_; }        // LwFrameProbes
    const Buffer& emitters() const { return emitters_; }  // lw_vpl, LW_PROBE_EMITTERS of them
    std::uint64_t bytes() const;
    // The most that bytes() becomes with so many RSMs, or fewer, and VPLs of the host's.
    static std::uint64_t estimateBytes(std::uint64_t maps, std::uint64_t vplCount);

private:
    void recordTexels(Executor& executor, const ProbedView& view, const RsmInput& rsms, const LWVpl* vpls, std::uint32_t vplCount);

    Device& device_;
    Kernel &texels_, &chunks_, &draw_, &pixels_, &rows_, &join_;
    Buffer maps_, authored_, texelPlanes_, places_, chunkSums_, emitters_, pixelPlanes_, rowSums_, probes_;
    std::uint32_t has_ = 0, chunkCount_ = 0;  // of the last record
    // What is being read, and what it was made of.
    LateRead<LwFrameProbes> late_;
    std::uint32_t lateHas_ = 0;
    FrameFigures taken_;
};

// Ratios of the sums; NaN where `has` (LW_PROBE_HAS_*) or the frame leaves nothing to measure a figure by.
FrameFigures probesOf(const LwFrameProbes& sums, std::uint32_t has);

}  // namespace lightwell
