// Irradiance of VPLs at G-buffer pixels, all VPLs per pixel or interleaved n x n with the edge-aware
// filter (Segovia et al. 2006).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/subset_order.h"

namespace lightwell {

class InterleavedGather {
public:
    // interleave: 1, 2, 4 or 8.
    InterleavedGather(Device& device, std::uint32_t interleave);

    // Pass "interleaved_gather.gather": irradiance (3 planes) from one subset of the VPLs (lw_vpl by slot)
    // per pixel, times the number of subsets. counts[0] grows by the pixels with neither
    // a surface nor a zero normal.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                      lw_subset_order order, const Planes& irradiance, const Buffer& counts);
    // Pass "interleaved_gather.filter"; irradiance and filtered are different images. interleave > 1 only.
    void recordFilter(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& filtered);
    // Pass "interleaved_gather.validity": 1 on surfaces, 0 elsewhere.
    void recordValidity(Executor& executor, const Planes& position, const Planes& normal, const Planes& validity);

    std::uint32_t interleave() const { return interleave_; }

private:
    std::uint32_t interleave_;
    Kernel &gather_, &validity_;
    Kernel* filter_ = nullptr;
};

}  // namespace lightwell
