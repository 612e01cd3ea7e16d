// Holes between splatted texels, filled from coarser levels.
#pragma once

#include <array>
#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "passes/paraboloid_map.h"
#include "shared/pull_push_types.h"

namespace lightwell {

class PullPush {
public:
    explicit PullPush(Device& device);

    // Records passes "pull_push.*": unknown texels of the stale maps take the plane and the albedo of what surrounds them.
    // Known texels stay as they are; holes too wide stay unknown.
    void record(Executor& executor, const MapTexels& maps);

    // Of a frame that keeps the last one's maps as they are: fills none.
    void recordKept(Executor& executor);

    void report(Report& report) const;  // filled_texels, of the last of both
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t clusterCount);

private:
    Device& device_;
    Kernel &pullRecords_, &pull_, &push_, &pushRecords_;
    std::array<Buffer, LW_FILL_LEVELS> levels_;  // half, a quarter ... of the maps' size
    Buffer filled_;
};

}  // namespace lightwell
