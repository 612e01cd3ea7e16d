// Irradiance of a view's pixels from a light propagation volume (kernels/lpv_read).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class LpvRead {
public:
    LpvRead(Device& device, std::uint32_t size);

    // Pass "lpv_read.pack", once a frame. `grid`: of LpvPropagation's. progress: none, or the LwLpvProgress of its steps, whose own
    // calibration then counts beside recordGather's, which is that of all steps.
    void recordPack(Executor& executor, const Buffer& grid, const Buffer* progress = nullptr);
    // Pass "lpv_read.gather". place: LpvGrid's. isDamped: no more light than a cell further off. irradiance, validity: none where
    // not wanted. counts: kCounts ints, raised by the number of pixels that are neither surface nor background, of those whose
    // light was brought down, and of surfaces that the grid does not have.
    static constexpr std::size_t kCounts = 3;
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& place, double calibration,
                      bool isDamped, const Planes& irradiance, const Planes& validity, const Buffer& counts);

    std::uint64_t bytes() const { return cells_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t size);

private:
    Device& device_;
    std::uint32_t size_;
    Kernel &pack_, &gather_;
    Buffer cells_;
};

}  // namespace lightwell
