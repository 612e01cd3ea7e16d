// Surfels drawn into paraboloid maps as oriented discs.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/surfel_set.h"
#include "passes/paraboloid_map.h"

namespace lightwell {

class SurfelSplat {
public:
    // Surfels that a map takes at most for each of its texels, by a hash of their places; those that it takes grow to
    // stand for the others as well. Raised, finer occluders and fewer cracks, and time in proportion; lowered, coarse discs
    // that reach over the edges of what they stand for.
    static constexpr std::uint32_t kPerTexel = 8;
    static std::uint32_t mostSurfels(std::uint32_t mapSize) { return kPerTexel * mapSize * mapSize; }

    explicit SurfelSplat(Device& device);

    // Records passes "surfel_splat.*": the surfels into the stale maps of `maps`, which ParaboloidMap has placed and
    // emptied. The bits depend neither on the order of the surfels nor on that of execution.
    void record(Executor& executor, const SurfelSet& surfels, const MapTexels& maps);

    std::uint64_t bytes() const { return candidates_.bytes(); }
    static std::uint64_t estimateBytes(std::uint64_t surfelCount, std::uint32_t clusterCount);

private:
    Device& device_;
    Kernel &clear_, &depth_, &normal_, &albedo_, &resolve_;
    Buffer candidates_;
};

}  // namespace lightwell
