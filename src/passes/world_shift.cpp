#include "passes/world_shift.h"

#include "compute/device.h"
#include "compute/float_parts.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr Range kGroup{16, 1};

}  // namespace

WorldStep worldStep(const WorldOrigin& from, const WorldOrigin& to) {
    WorldStep step;
    for (std::size_t a = 0; a < 3; ++a) {
        const double whole = to[a] - from[a];
        const double rest = restOf(whole);
        step.high.s[a] = roundedToFloat(whole);
        step.low.s[a] = roundedToFloat(rest);
        step.least.s[a] = float(restOf(rest));
    }
    return step;
}

// What lay at p of the old origin lies at p + old - new of the new one.
void KeptPlaces::move(Executor& executor, const Buffer& memory, Layout layout) const {
    if (layout.count == 0) return;
    const WorldStep step = worldStep(executor.worldOrigin(), origin_);
    Kernel& move = executor.device().programs().kernel("world_shift/world_shift", "world_shift_move");
    executor.run("world_shift.move", move, gridOver(layout.count), kGroup, memory, cl_int(layout.first), cl_int(layout.stride),
                 cl_int(layout.axis), cl_int(layout.count), step.high, step.low);
}

}  // namespace lightwell
