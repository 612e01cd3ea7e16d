// Sequences for tests of the stability indices, made in code.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "stability_indices.h"

namespace stability_test {

// Light of frame t at pixel x, y: grey.
using Light = std::function<double(int t, int x, int y)>;

// A picture that moves by `step` pixels to the right from frame to frame; all of it shows surfaces.
inline std::vector<studio::StabilityFrame> makeFrames(int count, int width, int height,
                                                      const Light& image, const Light& truth,
                                                      float step = 0.0f) {
    std::vector<studio::StabilityFrame> frames;
    for (int t = 0; t < count; ++t) {
        studio::StabilityFrame frame;
        frame.width = width;
        frame.height = height;
        const std::size_t pixels = std::size_t(width) * std::size_t(height);
        frame.surface.assign(pixels, 1);
        const float nan = std::numeric_limits<float>::quiet_NaN();
        frame.previous.assign(pixels, glm::vec2(nan));
        frame.image.resize(3 * pixels);
        frame.truth.resize(3 * pixels);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
                const float from = float(x) + 0.5f - step;
                if (t > 0 && from >= 0.0f && from < float(width))
                    frame.previous[i] = glm::vec2(from, float(y) + 0.5f);
                for (std::size_t c = 0; c < 3; ++c) {
                    frame.image[c * pixels + i] = float(image(t, x, y));
                    frame.truth[c * pixels + i] = float(truth(t, x, y));
                }
            }
        frames.push_back(std::move(frame));
    }
    return frames;
}

}  // namespace stability_test
