#include "passes/static_vpl_weights.h"

#include <algorithm>

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kBlock = 16;  // places: lanes at the widest
constexpr std::uint32_t kGroupLanes = 16;

std::size_t areaBytes(std::uint32_t places) {
    return std::size_t(paddedWidth(std::max(places, 1u))) * sizeof(float);
}

}  // namespace

StaticVplWeights::StaticVplWeights(Device& device, std::uint32_t comparisons)
    : device_(device),
      comparisons_(comparisons),
      nearest_(device.programs().kernel("static_vpl_weights/static_vpl_weights",
                                        "static_vpl_weights_nearest")) {}

void StaticVplWeights::reserve(std::uint32_t places, bool wanted) {
    // Kernels take some memory, also where none is read.
    areas_.reserve(device_, areaBytes(places), "areas of static VPLs");
    if (!wanted || known_ != places) known_ = next_ = 0;
    const std::uint32_t each = std::max(comparisons_ / std::max(places, 1u) / kBlock, 1u) * kBlock;
    cycle_ = (places + each - 1) / each;
}

void StaticVplWeights::record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame) {
    const auto places = std::uint32_t(frame.count);
    const bool all = known_ != places;
    const std::uint32_t each = std::max(comparisons_ / std::max(places, 1u) / kBlock, 1u) * kBlock;
    const std::uint32_t first = all ? 0 : next_, end = all ? places : std::min(first + each, places);
    known_ = places;
    next_ = all || end >= places ? 0 : end;
    if (end <= first) return;
    const std::uint32_t width = nearest_.width();
    executor.run("static_vpl_weights.nearest", nearest_, {(end - first + width - 1) / width, 1},
                 {std::max(kGroupLanes / width, 1u), 1}, inputs, frame, cl_int(first), cl_int(end),
                 areas_);
}

std::uint64_t StaticVplWeights::estimateBytes(std::uint32_t places) {
    return areaBytes(places);
}

}  // namespace lightwell
