// Phantom VPLs of spot lights, and VPLs that send a second bounce.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/light_list.h"
#include "passes/world_shift.h"
#include "shared/static_vpl_types.h"

namespace lightwell {

class PhantomVpl {
public:
    explicit PhantomVpl(Device& device);

    // VPLs beside the static ones that a frame's list has at its end, in this order: phantoms, with a
    // second bounce one opposite each, and one opposite the static ones.
    static std::uint32_t others(std::uint32_t phantoms, bool secondBounce) {
        return secondBounce ? 2 * phantoms + 1 : phantoms;
    }

    // Passes "phantom_vpl.make" and ".opposite": writes them into the lists, whose static VPLs are
    // culled. lit: StaticVplLight's. texels: RsmInput's, where a phantom's place comes from a map; else
    // empty.
    void record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                const Buffer& lit, const Planes& texels, lw_phantom_options options,
                const LightList& list);
    // The states of the last frame are no matter in the next record().
    void forget() { known_ = 0; }

    std::uint64_t bytes() const { return states_.bytes(); }
    static std::uint64_t estimateBytes(std::uint32_t phantoms);

private:
    Device& device_;
    Kernel &make_, &opposite_;
    Buffer states_;
    std::uint32_t known_ = 0;
    KeptPlaces kept_;
};

}  // namespace lightwell
