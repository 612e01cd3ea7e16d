// Scalar maps as pictures.
#pragma once

#include <vector>

#include "image.h"

namespace studio {

// Values 0 ... 1 from black through blue, violet, rose and sand to white; brightness rises evenly, so
// the order is kept in grey print. Values outside saturate. The result is display-referred linear, for
// writePng.
Image falseColour(const std::vector<float>& values, int width, int height);

}  // namespace studio
