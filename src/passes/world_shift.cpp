#include "passes/world_shift.h"

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr Range kGroup{16, 1};

}  // namespace

WorldStep worldStep(const WorldOrigin& from, const WorldOrigin& to) {
    WorldStep step;
    for (std::size_t a = 0; a < 3; ++a) {
        const double whole = to[a] - from[a];
        // Volatile: GCC 12.2 at -O3 leaves out the rounding to a float and back, and finds nothing left.
        const volatile float high = float(whole), low = float(whole - double(high));
        step.high.s[a] = high;
        step.low.s[a] = low;
        step.least.s[a] = float(whole - double(high) - double(low));
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
