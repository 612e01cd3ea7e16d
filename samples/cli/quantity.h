// What is asked of a technique, and how it is called.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"

namespace cli {

enum class Quantity { Irradiance, AmbientOcclusion, SpecularRadiance, RefractedRadiance, Shadow };

struct QuantityEntry {
    Quantity quantity;
    const char* name;            // of --quantity
    const char* layer;           // in a picture's metadata
    LWImage LWOutput::*output;
    bool isShare;                // in [0, 1]: one number of each pixel, drawn as it is
    bool hasRoughness;           // depends on the pixels'
};

inline const std::array<QuantityEntry, 5>& quantityEntries() {
    static const std::array<QuantityEntry, 5> entries = {{
        {Quantity::Irradiance, "irradiance", "irradiance", &LWOutput::irradiance, false, false},
        {Quantity::AmbientOcclusion, "ambient-occlusion", "ambient", &LWOutput::ambientOcclusion, true, false},
        {Quantity::SpecularRadiance, "specular-radiance", "specular", &LWOutput::specularRadiance, false, true},
        {Quantity::RefractedRadiance, "refracted-radiance", "refracted", &LWOutput::refractedRadiance, false, true},
        {Quantity::Shadow, "shadow", "shadow", &LWOutput::shadow, true, false},
    }};
    return entries;
}

inline const QuantityEntry& entryOf(Quantity quantity) { return quantityEntries().at(std::size_t(quantity)); }

inline std::vector<std::string> quantityNames() {
    std::vector<std::string> names;
    for (const QuantityEntry& entry : quantityEntries()) names.emplace_back(entry.name);
    return names;
}

}  // namespace cli
