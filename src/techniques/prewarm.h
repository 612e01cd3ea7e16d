// Runs a technique on small made-up inputs, once per way a host can hand them over, so that every kernel
// that a frame can need is built and has been launched.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

// Blocks until the device has finished. The technique's state is that of the last made-up frame. kinds: OutputKinds that it makes too,
// beside the other outputs and alone. spots: of one whose static VPLs are lit: with a spot light and its map, blockers and baked receivers.
void exerciseTechnique(Executor& executor, Technique& technique, std::uint32_t kinds = 0, bool spots = false);
// The same for its light at points, after that. Of one that has none at them: not to be called.
void exercisePoints(Executor& executor, Technique& technique);

}  // namespace lightwell
