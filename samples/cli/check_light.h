// What a fault of the inputs does to the picture: the light of spoilt inputs against that of sound ones.
#pragma once

#include <lightwell/lightwell.hpp>
#include <string>

namespace cli {

struct LightChange {
    std::string refusal;             // what the library said instead of making light; then nothing else is known
    double mean = 1.0;               // irradiance, of that of sound inputs
    double black = 0.0, off = 0.0;   // shares of the lit pixels: that have none any more; that are off by more than a tenth
};

// technique: by name, then its settings, as lwCreateTechniqueFromText takes them: "ssvp clusters=16".
LightChange changeOfLight(const lightwell::Device& device, const lightwell::View& view, const std::string& technique,
                          const LWFrame& soundFrame, const LWGBuffer& soundGBuffer, const LWFrame& frame, const LWGBuffer& gbuffer);

}  // namespace cli
