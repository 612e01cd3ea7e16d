// Errors of an image against a reference; docs/accuracy.md states each formula.
#pragma once

#include <string>

#include "image.h"

namespace studio {

struct Metrics {
    // On linear HDR indirect irradiance R,G,B; pixels without a surface in both are left out.
    double relMse = 0.0;   // mean (F-R)^2 / (R^2 + 0.01 mean(R)^2)
    double nrmse = 0.0;    // RMSE / mean(R)
    double bias = 0.0;     // mean(F-R) / mean(R)
    double p99 = 0.0;      // 99th percentile of the square root of relMse's term
    // On the tone-mapped composite.
    double rmse = 0.0, ssim = 0.0;
    double score = 0.0, score255 = 0.0;  // 0..10
    double flip = 0.0;
    // Estimated relMSE of the reference itself from its two halves; negative: not stored in it.
    double referenceNoise = -1.0;
};

struct MetricMaps { Image relativeError, ssim, flip; };

// Both images carry R,G,B (irradiance) and direct.*, albedo.* for the composite (taken from the
// reference when the image has none). Throws std::runtime_error when sizes differ or layers miss.
Metrics compareImages(const Image& image, const Image& reference, MetricMaps* maps = nullptr);

}  // namespace studio
