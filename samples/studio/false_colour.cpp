// Green 2011, "A colour scheme for the display of astronomical intensity images": a helix around the
// grey diagonal of the colour cube.
#include "false_colour.h"

#include <algorithm>
#include <cmath>

namespace studio {
namespace {

constexpr float kTwoPi = 6.28318531f;
constexpr float kStart = 2.4f;       // hue at black: 1 red, 2 green, 3 blue
constexpr float kRotations = 0.9f;   // turns from black to white; more turns, more ambiguous hues
constexpr float kSaturation = 1.2f;  // above about 1.3 the helix leaves the cube and steps flatten

struct Colour {
    float r, g, b;
};

Colour helix(float value) {
    const float angle = kTwoPi * (kStart / 3.0f + 1.0f + kRotations * value);
    const float amplitude = kSaturation * value * (1.0f - value) / 2.0f;
    const float c = amplitude * std::cos(angle), s = amplitude * std::sin(angle);
    return {value - 0.14861f * c + 1.78277f * s, value - 0.29227f * c - 0.90649f * s,
            value + 1.97294f * c};
}

}  // namespace

Image falseColour(const std::vector<float>& values, int width, int height) {
    Image picture(width, height);
    std::vector<float>&r = picture.plane("R"), &g = picture.plane("G"), &b = picture.plane("B");
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Colour colour = helix(std::clamp(values[i], 0.0f, 1.0f));
        r[i] = srgbDecode(std::clamp(colour.r, 0.0f, 1.0f));
        g[i] = srgbDecode(std::clamp(colour.g, 0.0f, 1.0f));
        b[i] = srgbDecode(std::clamp(colour.b, 0.0f, 1.0f));
    }
    return picture;
}

}  // namespace studio
