// Structural similarity of display values, and the 0-10 score built on it.
#pragma once

#include <cstddef>
#include <vector>

#include "image.h"

namespace studio {

// Gaussian-weighted local moments of a pair of planes (11x11 window, sigma 1.5, mirrored borders). The
// variance of the difference is kept in place of the covariance: it is exactly 0 for equal planes, and
// keeps its digits where SSIM is within 1e-6 of 1, which the score's power 1000 magnifies.
struct LocalMoments {
    std::vector<double> meanX, meanY;
    std::vector<double> varianceSum;         // var(x) + var(y)
    std::vector<double> differenceVariance;  // var(x - y)
};
LocalMoments localMoments(const std::vector<float>& x, const std::vector<float>& y, int width,
                          int height);

// SSIM at one pixel with C1 = (0.01 range)^2, C2 = (0.03 range)^2; at most 1.
double ssimAt(const LocalMoments& moments, std::size_t pixel, double range);

struct SsimResult {
    double ssim = 0.0;   // mean over channels and over all windows that lie wholly inside the picture
    double score = 0.0;  // 0..10 with range 255 on [0,1] values, the constants of the published scores
    double score255 = 0.0;   // 0..10 with the constants that fit the values
    std::vector<float> map;  // SSIM (range 1) per pixel, mean over the channels
};

// `x` and `y`: R, G, B display values in [0,1] as encoded for the screen (sRGB), equal sizes.
SsimResult compareSsim(const Image& x, const Image& y);

}  // namespace studio
