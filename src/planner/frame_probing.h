// A frame's probes from the host's own images: inputs on the device, the pass frame_probes, and its result.
#pragma once

#include <cstdint>
#include <vector>

#include "inputs/gbuffer_input.h"
#include "inputs/rsm_input.h"
#include "inputs/view.h"
#include "passes/frame_probes.h"

namespace lightwell {

class FrameProbing {
public:
    explicit FrameProbing(Device& device) : device_(device), probes_(device) {}

    // Throws what record() would say of these arguments.
    static void check(Device& device, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer);
    static void checkView(Device& device, const View& view, const LWGBuffer& gbuffer);
    // Records unpacking and probes, and has these read when the queue gets there. `gbuffer`: of the view that is to be lit.
    // While a read is under way nothing is recorded.
    void record(Executor& executor, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer);
    // The same in two steps, where the frame is known before the view: its RSMs, then the rest and the read.
    void beginFrame(Executor& executor, const LWFrame& frame);
    void recordView(Executor& executor, const View& view, const LWGBuffer& gbuffer);
    bool isReading() const { return probes_.isReading(); }
    // What has come since the last call; null where nothing has, or commands failed. Waits for nothing.
    const FrameFigures* take() { return probes_.take(); }
    // The most that bytes() becomes.
    static std::uint64_t estimateBytes(const LWViewDesc& view, const FrameShape& shape);
    std::uint64_t bytes() const { return gbuffer_.bytes() + rsms_.bytes() + probes_.bytes(); }

private:
    Device& device_;
    GBufferInput gbuffer_;
    RsmInput rsms_;
    std::vector<LWVpl> vpls_;
    FrameProbes probes_;
};

}  // namespace lightwell
