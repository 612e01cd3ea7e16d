#include "passes/pull_push.h"

#include <algorithm>
#include <limits>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "pull_push/pull_push";

std::uint32_t widthOf(std::uint32_t size, std::size_t level) { return size >> (level + 1); }

// Floats of a plane of one map.
std::uint64_t strideOf(std::uint32_t size, std::size_t level) {
    const std::uint64_t width = widthOf(size, level);
    return (width * width + 15) / 16 * 16;
}

std::uint64_t levelBytes(std::uint32_t size, std::size_t level, std::uint32_t maps) {
    const std::uint64_t floats = strideOf(size, level) * LW_FILL_PLANES * std::max(maps, 1u);
    if (floats > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "clusters: the levels that fill ", maps, " maps of ", size, " x ", size,
             " texels exceed the 32-bit indices of the kernels");
    return floats * sizeof(float);
}

}  // namespace

PullPush::PullPush(Device& device)
    : device_(device),
      pullRecords_(device.programs().kernel(kProgram, "pull_push_pull_records")),
      pull_(device.programs().kernel(kProgram, "pull_push_pull")),
      push_(device.programs().kernel(kProgram, "pull_push_push")),
      pushRecords_(device.programs().kernel(kProgram, "pull_push_push_records")) {}

void PullPush::recordKept(Executor& executor) {
    if (filled_) executor.fill("pull_push.clear", filled_, 0, 0, sizeof(cl_uint));
}

void PullPush::record(Executor& executor, const MapTexels& maps) {
    filled_.reserve(device_, sizeof(cl_uint), "count of filled texels");
    executor.fill("pull_push.clear", filled_, 0, 0, sizeof(cl_uint));
    if (maps.mapCount == 0) return;
    for (std::size_t l = 0; l < levels_.size(); ++l)
        levels_[l].reserve(device_, std::size_t(levelBytes(maps.size, l, maps.mapCount)), "levels of pull-push");
    const cl_int size = cl_int(maps.size);
    const Range group = rowGroup(device_);
    const auto stride = [&](std::size_t l) { return cl_int(strideOf(maps.size, l)); };
    const auto width = [&](std::size_t l) { return cl_int(widthOf(maps.size, l)); };
    const auto grid = [&](std::size_t l) {
        return Range{std::size_t(strideOf(maps.size, l)) / device_.width(), maps.mapCount};
    };
    executor.run("pull_push.pull", pullRecords_, grid(0), group, maps.states, maps.records, maps.albedo, size, levels_[0],
                 stride(0));
    for (std::size_t l = 1; l < levels_.size(); ++l)
        executor.run("pull_push.pull", pull_, grid(l), group, maps.states, levels_[l - 1], stride(l - 1), width(l - 1),
                     levels_[l], stride(l));
    for (std::size_t l = levels_.size() - 1; l-- > 0;)
        executor.run("pull_push.push", push_, grid(l), group, maps.states, levels_[l + 1], stride(l + 1), width(l),
                     levels_[l], stride(l));
    executor.run("pull_push.push", pushRecords_, Range{std::size_t(maps.size) * maps.size / device_.width(), maps.mapCount},
                 group, maps.states, levels_[0], stride(0), size, maps.records, maps.albedo, filled_);
}

void PullPush::report(Report& report) const {
    if (filled_) report.read(device_, "filled_texels", filled_, 0);
}

std::uint64_t PullPush::bytes() const {
    std::uint64_t total = filled_.bytes();
    for (const Buffer& level : levels_) total += level.bytes();
    return total;
}

std::uint64_t PullPush::estimateBytes(std::uint32_t size, std::uint32_t clusterCount) {
    std::uint64_t total = sizeof(cl_uint);
    for (std::size_t l = 0; l < LW_FILL_LEVELS; ++l) total += levelBytes(size, l, clusterCount);
    return total;
}

}  // namespace lightwell
