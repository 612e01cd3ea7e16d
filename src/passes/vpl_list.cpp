#include "passes/vpl_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compute/error.h"

namespace lightwell {

Range gridOver(std::size_t count) {
    constexpr std::size_t kRow = std::size_t(1) << 17;
    return {std::min(count, kRow), (count + kRow - 1) / kRow};
}

cl_float2 sampleRotation(std::uint32_t seed, std::uint32_t turns) {
    auto unit = [](std::uint32_t x) {
        x = (x ^ (x >> 16)) * 0x85ebca6bu;
        x = (x ^ (x >> 13)) * 0xc2b2ae35u;
        return float((x ^ (x >> 16)) >> 8) / 16777216.0f;
    };
    cl_float2 shift = {{0.0f, 0.0f}};
    if (seed) shift = {{unit(seed), unit(seed ^ 0x9e3779b9u)}};
    // 1/g and 1/g^2 of the plastic number g, the root of g^3 = g + 1.
    const auto turned = [turns](float start, double step) {
        const double at = double(start) + double(turns) * step;
        return float((at - std::floor(at)) * (1.0 - 6e-8));  // rounding up must not reach 1
    };
    if (turns) shift = {{turned(shift.s[0], 0.75487766624669276), turned(shift.s[1], 0.56984029099805327)}};
    return shift;
}

lw_subset_order subsetOrder(std::uint32_t count, std::uint32_t subsets) {
    // The middle bits choose the subset: as many index bits above them as below.
    std::uint32_t step = 1;
    while (std::uint64_t(step) * 2 * step * 2 * subsets <= count) step *= 2;
    const std::uint64_t rounds = (count + std::uint64_t(step) * subsets - 1) / (std::uint64_t(step) * subsets);
    std::uint64_t capacity = std::max<std::uint64_t>(rounds, 1) * step;
    capacity += capacity & 1;  // the gather takes two VPLs at a time
    if (capacity * subsets * 12 > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "vpls: ", count, " VPLs exceed the 32-bit indices of the kernels");
    lw_subset_order order;
    order.subsets = cl_int(subsets);
    order.step = cl_int(step);
    order.capacity = cl_int(capacity);
    order.count = cl_int(count);
    return order;
}

}  // namespace lightwell
