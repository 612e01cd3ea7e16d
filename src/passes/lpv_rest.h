// Whether a grid's light is that of the frame before, found on the device, where passes that carry it leave at once if so
// (kernels/lpv_rest).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"

namespace lightwell {

class LpvRest {
public:
    explicit LpvRest(Device& device);

    // Pass "lpv_rest.decide". begin(), then what the light is resolved by raises changed() where it differs from what it was, then
    // decide(). blockers: the state of what blocks, LwLpvBlockers or LwSweepCover; null: nothing does. isKnown: all else is as it was, and
    // the last frame's light is still there.
    void begin(Executor& executor);
    const Buffer& changed() const { return changed_; }  // an int
    void decide(Executor& executor, const Buffer& place, const Buffer* blockers, bool isKnown);

    const Buffer& state() const { return state_; }  // LwLpvProgress: done where it rests
    void report(Device& device, Report& report) const;  // choice "rests"
    std::uint64_t bytes() const { return changed_.bytes() + last_.bytes() + state_.bytes(); }
    static std::uint64_t estimateBytes();

private:
    Kernel& decide_;
    Buffer changed_, last_, state_;
};

}  // namespace lightwell
