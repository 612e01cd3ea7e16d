// Areas of static VPLs by the distance to the nearest other one, a part of them in each frame.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/static_vpl_types.h"

namespace lightwell {

class StaticVplWeights {
public:
    // comparisons: distances that a frame looks at, rounded down to whole blocks of 16 places, one at least.
    StaticVplWeights(Device& device, std::uint32_t comparisons);

    // Makes room for places, and forgets the areas where their number has changed. Without `wanted`
    // nothing else.
    void reserve(std::uint32_t places, bool wanted);
    // Pass "static_vpl_weights.nearest": the next block of places; all of them where nothing is known
    // (after reserve() or forget()).
    void record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame);
    void forget() { known_ = 0; }

    const Buffer& areas() const {
        return areas_;
    }  // a plane, m^2; places in others' way count in every direction
    std::uint32_t cycle() const { return cycle_; }  // frames of a round
    std::uint64_t bytes() const { return areas_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t places);

private:
    Device& device_;
    std::uint32_t comparisons_;
    Kernel& nearest_;
    Buffer areas_;
    std::uint32_t known_ = 0;  // number of places whose areas are known, all or none
    std::uint32_t next_ = 0, cycle_ = 0;
};

}  // namespace lightwell
