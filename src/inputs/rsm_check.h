// Reflective shadow maps as a frame describes them, checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "inputs/camera.h"
#include "inputs/image_check.h"
#include "inputs/rsm_input.h"
#include "shared/rsm_types.h"
#include "shared/unproject_types.h"

namespace lightwell {

struct CheckedRsm {
    std::optional<CheckedImage> position, depth;
    CheckedImage normal, flux;
    Camera camera;
    LwUnprojection unprojection{};
    LwRsmSpan span{};
    std::uint64_t version = 0;

    const CheckedImage& place() const { return depth ? *depth : *position; }
};

// All maps of a frame in the order of its lights, and where each lies among the texels. Throws INVALID_ARGUMENT.
std::vector<CheckedRsm> checkLights(Device& device, const LWFrame& frame, std::vector<RsmSpan>& spans);
// Throws INVALID_ARGUMENT, of `name`, beyond what kernels can count.
void checkRsmTexels(std::uint64_t padded, const char* name);

}  // namespace lightwell
