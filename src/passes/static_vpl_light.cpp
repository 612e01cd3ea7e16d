#include "passes/static_vpl_light.h"

#include <algorithm>

#include "compute/device.h"

namespace lightwell {
namespace {

// Lanes of a work-group at every width: few, so that even some dozens of places occupy several cores.
constexpr std::uint32_t kGroupLanes = 64;

std::size_t litBytes(std::size_t stride) {
    return stride * LW_LIT_PLANES * sizeof(float);
}

}  // namespace

StaticVplLight::StaticVplLight(Device& device)
    : device_(device),
      update_(device.programs().kernel("static_vpl_light/static_vpl_light", "static_vpl_light_update")) {
}

void StaticVplLight::record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                            const Buffer& nearest) {
    lit_.reserve(device_, litBytes(std::size_t(frame.stride)), "light of static VPLs");
    const std::uint32_t width = update_.width();
    executor.run("static_vpl_light.update", update_,
                 {(std::uint32_t(frame.stride) + width - 1) / width, 1},
                 {std::max(kGroupLanes / width, 1u), 1}, inputs, frame, nearest, lit_);
}

std::uint64_t StaticVplLight::estimateBytes(std::uint32_t places) {
    return litBytes(paddedWidth(std::max(places, 1u)));
}

}  // namespace lightwell
