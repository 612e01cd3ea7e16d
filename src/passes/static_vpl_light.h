// Flux of static VPLs from a frame's lights, past soft blockers.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/static_vpl_types.h"

namespace lightwell {

class StaticVplLight {
public:
    explicit StaticVplLight(Device& device);

    // Pass "static_vpl_light.update". inputs: StaticVplInput's memory, whose first word gets the
    // strongest intensity. nearest: a plane of areas, m^2, of places without one of their own.
    void record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                const Buffer& nearest);

    const Buffer& lit() const { return lit_; }  // LW_LIT_PLANES planes, frame.stride floats apart
    std::uint64_t bytes() const { return lit_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t places);

private:
    Device& device_;
    Kernel& update_;
    Buffer lit_;
};

}  // namespace lightwell
