// Names what is wrong with what a host hands over: lwCheckInputs. A debugging aid that runs on the host;
// docs/checking-inputs.md holds the reasoning and the thresholds.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/executor.h"
#include "inputs/view.h"
#include "lightwell/lightwell.h"

namespace lightwell {

const std::vector<LWInputFaultInfo>& inputFaults();  // indexed by LWInputFault

// One G-buffer to check; `name` begins its arguments.
struct CheckedView {
    const View* view;
    const LWGBuffer* gbuffer;
    const char* name;
};

// Reads everything back (blocking) and returns the findings, the most severe first. `views[0]` is the
// one that `overlay` (may be null) shows. Throws what RsmInput and GBufferInput would.
std::vector<LWInputFinding> checkInputs(Executor& executor, const LWFrame* frame,
                                        const std::vector<CheckedView>& views, const LWImage* overlay);

}  // namespace lightwell
