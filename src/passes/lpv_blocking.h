// What blocks light between the cells of a light propagation volume, made of surfels (kernels/lpv_blocking): the geometry volume of
// Kaplanyan and Dachsbacher 2010.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/geometry_input.h"
#include "inputs/surfel_set.h"
#include "passes/lpv_propagation.h"

namespace lightwell {

// Surfels that one view has seen, `count` from `first` on: they add up. What several views have seen is merged.
struct SurfelRange {
    std::uint32_t first, count;
};

class LpvBlocking {
public:
    LpvBlocking(Device& device, std::uint32_t size);

    // Passes "lpv_blocking.*". place: LpvGrid's. Made anew where the grid has moved or the surfels' revision is another.
    void record(Executor& executor, const SurfelSet& surfels, const std::vector<SurfelRange>& views, const Buffer& place);
    // The same of triangles, as samples on the grid's lattice. Where the grid has moved by whole cells of the world, what stays in it is
    // kept, and the triangles are looked at for what came in: the same bits as all anew.
    void record(Executor& executor, const GeometryInput& triangles, const Buffer& place);
    void forget() { isKept_ = false; }  // the next record() makes all anew, whatever the revision

    LpvBlockers blockers() const { return {faces_, runs_}; }
    const Buffer& corners() const { return merged_; }  // a float4 each: what blocks there, of the last record() of surfels
    const Buffer& state() const { return state_; }  // LwLpvBlockers
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, bool scrolls = false);  // scrolls: of triangles

private:
    void reserve(Executor& executor);
    void begin(Executor& executor, std::uint64_t revision, const Buffer& place, bool scrolls);
    void merge(Executor& executor, bool isFirst);
    void end(Executor& executor);
    const Buffer& other() const { return other_ ? other_ : merged_; }  // a kernel's argument must be some memory

    Device& device_;
    std::uint32_t size_;
    Kernel &begin_, &inject_, &rasterise_, &merge_, &faceWays_, &markRuns_;
    Buffer sums_, merged_, other_, faces_, runs_, state_;
    bool isKept_ = false;
};

}  // namespace lightwell
