// When a propagation's steps may end: once what still moves is a small share of the light put in (kernels/lpv_propagation).
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class LpvProgress {
public:
    // At most `steps`, of a grid of `size` cells a side; target: the share. isBlocked: as LpvPropagation::calibration has it.
    LpvProgress(Device& device, std::uint32_t size, std::uint32_t steps, float target, bool isBlocked);

    // How many steps are taken before each look. All but the first are even: so steps end in the same grid, however many are left out.
    const std::vector<std::uint32_t>& chunks() const { return chunks_; }

    // Pass "lpv_propagation.look": no step has been taken; all chunks up to `chunk` have, and brought the sum from `before` to `now`.
    void begin(Executor& executor);
    void look(Executor& executor, std::size_t chunk, const Buffer& injected, const Buffer& before, const Buffer& now);

    const Buffer& state() const { return state_; }  // LwLpvProgress
    std::uint64_t bytes() const { return state_.bytes() + sums_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t size);

private:
    Device& device_;
    std::uint32_t size_;
    float target_;
    Kernel &sum_, &decide_;
    std::vector<std::uint32_t> chunks_, taken_;  // of each look: steps before it, in all
    std::vector<float> scales_;
    Buffer state_, sums_;
};

}  // namespace lightwell
