// Places that are kept from frame to frame, brought to the origin that a frame's positions are relative to (LWFrame::worldOrigin).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

// A difference of two points of the world, as three floats a coordinate, which hold all of a double. The first two do where it is no
// more than the world's places are apart.
struct WorldStep {
    cl_float4 high{}, low{}, least{};
};
WorldStep worldStep(const WorldOrigin& from, const WorldOrigin& to);  // from `from` to `to`

class KeptPlaces {
public:
    // In floats: coordinate a of place i at first + i * stride + a * axis.
    struct Layout {
        std::uint32_t count = 1, first = 0, stride = 4, axis = 1;
    };

    // Whether what was kept is relative to another origin than what the executor records: then move() each of its buffers, and arrive().
    bool moves(const Executor& executor) const { return executor.worldOrigin() != origin_; }
    // Pass "world_shift.move".
    void move(Executor& executor, const Buffer& memory, Layout layout) const;
    void arrive(const Executor& executor) { origin_ = executor.worldOrigin(); }

    const WorldOrigin& origin() const { return origin_; }

private:
    WorldOrigin origin_{};
};

}  // namespace lightwell
