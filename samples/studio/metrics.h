// Errors of an image against a reference; docs/accuracy.md states each formula.
#pragma once

#include <string>

#include "image.h"

namespace studio {

struct Metrics {
    // On linear HDR indirect irradiance R,G,B; pixels without a surface in both are left out. Means and
    // the percentile run over the remaining pixels and the channels alike.
    double relMse = 0.0;  // mean (F-R)^2 / (R^2 + 0.01 mean(R)^2)
    double nrmse = 0.0;   // RMSE / mean(R)
    double bias = 0.0;    // mean(F-R) / mean(R)
    double p99 = 0.0;     // 99th percentile of the square root of relMse's term
    // On the composite as shown: Reinhard under one exposure (the reference's), sRGB-encoded values in
    // [0,1].
    double rmse = 0.0, ssim = 0.0;
    double score = 0.0, score255 = 0.0;  // 0..10
    double flip = 0.0;
    // Estimated relMSE of the reference itself from its two halves; negative: not stored in it.
    double referenceNoise = -1.0;
};

// False-colour pictures for writePng, black = no error, white = 1 and above: square root of relMSE's
// term (mean over channels), 1 - SSIM, FLIP.
struct MetricMaps {
    Image relativeError, ssim, flip;
};

// Both images carry R,G,B (irradiance) and direct.*, albedo.* for the composite (taken from the
// reference when the image has none); normal.* tells surfaces from background. The reference's metadata
// "layer" names what stands in R,G,B ("bounce1", "all", a sum "bounce1+bounce2"); with it the noise
// comes from the halves "a.<layer>.*", "b.<layer>.*", or from metadata "noise.<layer>". Throws
// std::runtime_error when sizes differ, layers miss, a used channel holds NaN or infinity, or the
// reference is black.
Metrics compareImages(const Image& image, const Image& reference, MetricMaps* maps = nullptr);

// The errors of the irradiance alone, a tenth of the work; those of the composite stay 0.
Metrics compareIrradiance(const Image& image, const Image& reference);

}  // namespace studio
