// A frame's probes from the host's own images: inputs on the device, the pass frame_probes, and its result.
#pragma once

#include <cstdint>

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
    // Records unpacking and probes, and has these read when the queue gets there. `gbuffer`: of the view that is to be lit.
    // While a read is under way nothing is recorded.
    void record(Executor& executor, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer);
    // What has come since the last call; null where nothing has, or commands failed. Waits for nothing.
    const LWPlanProbes* take() { return probes_.take(); }
    std::uint64_t bytes() const { return gbuffer_.bytes() + rsms_.bytes() + probes_.bytes(); }

private:
    Device& device_;
    GBufferInput gbuffer_;
    RsmInput rsms_;
    FrameProbes probes_;
};

}  // namespace lightwell
