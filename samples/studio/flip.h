// FLIP: the difference a viewer sees when two pictures alternate on a screen.
#pragma once

#include <vector>

#include "image.h"

namespace studio {

// The authors' default: a 0.7 m wide monitor of 3840 pixels seen from 0.7 m.
constexpr double kFlipPixelsPerDegree = 67.0;

// FLIP in [0,1] per pixel of two display-referred linear pictures (R, G, B in [0,1], equal sizes).
// Symmetric in its arguments.
std::vector<float> flipMap(const Image& image, const Image& reference,
                           double pixelsPerDegree = kFlipPixelsPerDegree);

}  // namespace studio
