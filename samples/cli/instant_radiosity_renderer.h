// Instant radiosity (studio/instant_radiosity.h) as one more technique.
#pragma once

#include "indirect_renderer.h"

namespace cli {

const LWTechniqueInfo& instantRadiosityInfo();
std::unique_ptr<IndirectRenderer> makeInstantRadiosity(const Parameters& parameters,
                                                       const RenderInputs& inputs);

}  // namespace cli
