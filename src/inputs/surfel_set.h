// Surfels on the device, wherever they come from.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/surfel_types.h"

namespace lightwell {

// What passes that draw surfels read.
struct SurfelSet {
    Planes planes;                     // LW_SURFEL_PLANES of `width` surfels, whole blocks; radius 0: none. Empty: no surfels
    std::uint32_t count = 0;           // slots, of which some may hold none
    const Buffer* diagonal = nullptr;  // of the bounding box of the centres, a float, m; what is not there has none
    std::uint64_t revision = 0;        // differs whenever the surfels do
    // Where they emit: their LW_SURFEL_COUNTERS, and three more planes from LW_SURFEL_EMISSION on.
    const Buffer* emission = nullptr;
};

// Their memory.
class SurfelMemory {
public:
    // Room for `count` surfels in planes of whole blocks, of `planeCount` planes; counters and bounds emptied.
    void reset(Executor& executor, std::uint32_t count, std::uint32_t planeCount);
    // The diagonal, found on the device (pass "surfel_input.bounds") or given.
    void measure(Executor& executor);
    void setDiagonal(Executor& executor, float diagonal);
    void noteChange() { ++revision_; }
    void setEmits(bool emits) { emits_ = emits; }

    const Planes& planes() const { return planes_; }
    const Buffer& memory() const { return memory_; }
    const Buffer& counters() const { return counters_; }  // see surfel_types.h
    SurfelSet set() const { return {planes_, count_, &diagonal_, revision_, emits_ ? &counters_ : nullptr}; }
    std::uint64_t bytes() const { return memory_.bytes() + counters_.bytes() + diagonal_.bytes(); }
    static std::uint64_t estimateBytes(std::uint64_t count, std::uint32_t planeCount);

private:
    Buffer memory_, counters_, diagonal_;
    Planes planes_;
    std::uint32_t count_ = 0;
    bool emits_ = false;
    std::uint64_t revision_ = 0;
};

}  // namespace lightwell
