// The noise of a path-traced image, estimated from its two independent halves.
#pragma once

#include <cstddef>

#include <glm/glm.hpp>

namespace studio {

// relMSE of the mean R of two halves A and B: mean of (A-B)^2/4 / (R^2 + 0.01 mean(R)^2) over pixels and
// channels. (A-B)^2/4 is an unbiased estimate of R's squared error, as the halves' errors are
// independent and alike. R itself stands for the truth in the denominator, so that at few samples pixels
// that found no light yet look better than they are. fetch(pixel, a, b): false where there is no
// surface.
template <class Fetch>
double halvesRelMse(std::size_t pixels, const Fetch& fetch) {
    glm::dvec3 a, b;
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (!fetch(i, a, b)) continue;
        for (int c = 0; c < 3; ++c) sum += 0.5 * (a[c] + b[c]);
        count += 3.0;
    }
    if (sum <= 0.0) return 0.0;
    const double floor = 0.01 * (sum / count) * (sum / count);

    double error = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (!fetch(i, a, b)) continue;
        for (int c = 0; c < 3; ++c) {
            const double mean = 0.5 * (a[c] + b[c]), half = 0.5 * (a[c] - b[c]);
            error += half * half / (mean * mean + floor);
        }
    }
    return error / count;
}

}  // namespace studio
