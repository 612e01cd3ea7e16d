// Triangles as surfels, drawn by area on the device.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/geometry_input.h"
#include "inputs/surfel_set.h"

namespace lightwell {

class SurfelSampling {
public:
    explicit SurfelSampling(Device& device);

    // Pass "surfel_sampling.draw": `count` surfels of equal area, together that of the triangles, evenly over it; again
    // only when the geometry changed. The same triangles give the same surfels.
    void record(Executor& executor, const GeometryInput& geometry, std::uint32_t count);

    SurfelSet surfels() const { return memory_.set(); }
    std::uint64_t bytes() const { return memory_.bytes() + shares_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t triangleCount, std::uint32_t count);

private:
    Kernel& draw_;
    SurfelMemory memory_;
    Buffer shares_;
    std::uint64_t drawnRevision_ = 0;  // of the geometry; 0: none yet
};

}  // namespace lightwell
