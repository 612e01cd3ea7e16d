// Ambient occlusion, and one bounce, from points in each pixel's hemisphere (kernels/point_occlusion).
#pragma once

#include <optional>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class Camera;

struct PointOcclusionOptions {
    std::uint32_t points = 16;
    double radius = 0.1;  // in image heights at the pixel's depth
    bool packed = true;   // points crowd towards the pixel
    bool rangeCheck = true;
    bool cosine = true;  // directions by their cosine, or all alike
    bool light = false;
};

class PointOcclusion {
public:
    PointOcclusion(Device& device, const PointOcclusionOptions& options);

    // Pass "point_occlusion.gather" (".gather_ambient" without light). level: of a pyramid with depth, and radiance
    // with light; `every` pixels of the full image, which is fullHeight high, make one of its texels a side. turn: another set of
    // points in every frame of a history.
    void record(Executor& executor, const Planes& level, std::uint32_t every, std::uint32_t fullHeight, const Camera& camera,
                std::uint32_t turn, const Planes& gathered);

    void forget() { uploaded_.reset(); }  // what was uploaded may have been lost

    std::uint64_t bytes() const { return points_.bytes() + rotations_.bytes(); }
    static std::uint64_t estimateBytes(const PointOcclusionOptions& options);

private:
    PointOcclusionOptions options_;
    Kernel& gather_;
    Buffer points_, rotations_;
    std::optional<std::uint32_t> uploaded_;  // turn of the points on the device
};

}  // namespace lightwell
