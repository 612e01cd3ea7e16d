// From a frame's pixels to the places of their surfaces in a picture that another camera drew.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/camera.h"
#include "shared/history_types.h"

namespace lightwell {

// In a picture of width x height that `camera` drew; `now`: any image of the frame's size. before, after: the origins that the picture's
// positions and the frame's are relative to.
LwReprojection reprojection(const Camera& camera, std::uint32_t width, std::uint32_t height, const Planes& now,
                            const WorldOrigin& before = {}, const WorldOrigin& after = {});

// Row stride of pictures with many planes. All planes of a row lie side by side, a cache line apart: planes of a whole picture often
// lie a multiple of 4096 bytes apart (1280 x 720 does), and thirty of them then contend for the same few places of the first-level cache.
inline std::uint64_t historyPlaneStride(std::uint32_t width) { return paddedWidth(width) + 16u; }
// Such a picture's `count` planes in `image`.
Planes historyPlanes(const Buffer& image, std::uint32_t width, std::uint32_t height, std::uint32_t count);

}  // namespace lightwell
