// What `lightwell reference` writes of a traced picture.
#pragma once

#include <string>
#include <vector>

#include "image.h"

namespace cli {

// R, G, B: the sum of the chosen layers, whose halves a.<layer>.*, b.<layer>.* come along; then every
// layer: direct_irradiance ("direct" is taken by the radiance L_d), bounce1, bounce2, all.
studio::Image assembleReference(const studio::Image& traced, const std::vector<std::string>& chosen,
                                bool isCompact);

}  // namespace cli
