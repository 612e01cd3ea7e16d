#include "check_light.h"

#include <cmath>
#include <vector>

namespace cli {
namespace {

constexpr double kOff = 0.1;  // of a pixel's light, from which it counts as another
constexpr int kFrames = 2;    // the second has what techniques keep

std::vector<float> lightOf(const lightwell::Device& device, const lightwell::View& view, const std::string& text, const LWFrame& frame,
                           const LWGBuffer& gbuffer) {
    const std::size_t space = text.find(' ');
    auto technique = lightwell::Technique::fromText(device, text.substr(0, space).c_str(),
                                                    space == std::string::npos ? "" : text.c_str() + space + 1);
    const auto [width, height] = view.size();
    std::vector<float> pixels(3 * std::size_t(width) * height);
    auto output = lightwell::make<LWOutput>();
    output.irradiance.host = pixels.data();
    output.irradiance.format = LW_FORMAT_FLOAT3;
    output.irradiance.width = width;
    output.irradiance.height = height;
    for (int f = 0; f < kFrames; ++f) {
        technique.update(frame);
        technique.render(view, gbuffer, output);
    }
    lightwell::Device(device).finish();
    return pixels;
}

double sumAt(const std::vector<float>& pixels, std::size_t i) {
    return double(pixels[3 * i]) + double(pixels[3 * i + 1]) + double(pixels[3 * i + 2]);
}

}  // namespace

LightChange changeOfLight(const lightwell::Device& device, const lightwell::View& view, const std::string& technique,
                          const LWFrame& soundFrame, const LWGBuffer& soundGBuffer, const LWFrame& frame, const LWGBuffer& gbuffer) {
    const std::vector<float> sound = lightOf(device, view, technique, soundFrame, soundGBuffer);
    LightChange change;
    std::vector<float> spoilt;
    try {
        spoilt = lightOf(device, view, technique, frame, gbuffer);
    } catch (const lightwell::Error& error) {
        change.refusal = error.what();
        return change;
    }
    double soundSum = 0.0, spoiltSum = 0.0, lit = 0.0;
    for (std::size_t i = 0; i < sound.size() / 3; ++i) {
        const double before = sumAt(sound, i), now = sumAt(spoilt, i);
        soundSum += before;
        spoiltSum += now;
        if (!(before > 0.0)) continue;
        lit += 1.0;
        if (now == 0.0) change.black += 1.0;
        if (std::abs(now - before) > kOff * before) change.off += 1.0;
    }
    change.mean = spoiltSum / soundSum;
    change.black /= lit;
    change.off /= lit;
    return change;
}

}  // namespace cli
