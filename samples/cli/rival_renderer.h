// The rival (studio/rival.h) as one more technique: its parameters in the library's form, its frames
// behind the common interface.
#pragma once

#include "indirect_renderer.h"

namespace cli {

const LWTechniqueInfo& rivalInfo();
std::unique_ptr<IndirectRenderer> makeRival(const Parameters& parameters, const RenderInputs& inputs);

}  // namespace cli
