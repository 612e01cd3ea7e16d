// Runs a technique on small made-up inputs, once per way a host can hand them over, so that every kernel
// that a frame can need is built and has been launched.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

// Blocks until the device has finished. The technique's state is that of the last made-up frame. makesAmbient: of
// one that makes ambient occlusion too, beside the other outputs and alone; makesSpecular: the same of radiance along glossy lobes.
void exerciseTechnique(Executor& executor, Technique& technique, bool makesAmbient = false, bool makesSpecular = false);

}  // namespace lightwell
