// A view of technique auto while its light is kept or faded: the candidate's light on the device, mixed with what was shown last.
#pragma once

#include <functional>

#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "passes/cross_fade.h"

namespace lightwell {

class AutoView {
public:
    AutoView(Device& device, const View& view);

    void startFrame(bool forget) { fade_.startFrame(forget); }
    // A frame that its candidate writes to the host's images by itself.
    void skip() { fade_.forget(); }

    // Has `candidate` make its light in memory of ours and writes the host's images. share: of the new light, above 0 to 1.
    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, CrossFade& fade, float share,
                const std::function<void(const LWOutput&)>& candidate);

    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWViewDesc& view, bool uploads);

private:
    PlanarImage irradiance_, validity_;  // the candidate's
    GBufferInput gbuffer_;
    OutputTarget shownIrradiance_, shownValidity_;
    FadedView fade_;
};

}  // namespace lightwell
