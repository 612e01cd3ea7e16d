#include "passes/lpv_rest.h"

#include <cstddef>

#include "compute/device.h"
#include "shared/lpv_types.h"

namespace lightwell {

LpvRest::LpvRest(Device& device)
    : decide_(device.programs().kernel("lpv_rest/lpv_rest", "lpv_rest_decide")),
      changed_(device, sizeof(cl_int), "whether light has changed"),
      last_(device, sizeof(LwLpvPlace), "the last frame's place"),
      state_(device, sizeof(LwLpvProgress), "whether light rests") {}

std::uint64_t LpvRest::estimateBytes() { return sizeof(cl_int) + sizeof(LwLpvPlace) + sizeof(LwLpvProgress); }

void LpvRest::begin(Executor& executor) { executor.fill("lpv_rest.decide", changed_, 0, 0, changed_.bytes()); }

void LpvRest::decide(Executor& executor, const Buffer& place, const Buffer* blockers, bool isKnown) {
    // A kernel's argument must be some memory, also where it is not read.
    executor.run("lpv_rest.decide", decide_, {1, 1}, {1, 1}, changed_, place, blockers ? *blockers : changed_, cl_int(blockers ? 1 : 0),
                 cl_int(isKnown ? 1 : 0), last_, state_);
}

void LpvRest::report(Device& device, Report& report) const {
    static constexpr const char* kReasons[] = {"no: light, its place or what blocks it has changed", "yes: all is as it was in the frame before"};
    report.readChoice(device, "rests", state_, offsetof(LwLpvProgress, done), kReasons, 2);
}

}  // namespace lightwell
