// Skeleton of a technique (docs/adding-a-technique.md): an evenly bright sky that nothing hides.
#pragma once

#include "techniques/technique.h"

// In a real technique this struct stands in lightwell.h.
struct AmbientSkyDesc {
    std::uint32_t structSize;
    float gain;  // factor on the sky's radiance
};

namespace lightwell {

const TechniqueEntry& ambientSkyEntry();

}  // namespace lightwell
