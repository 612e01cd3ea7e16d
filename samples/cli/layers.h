// Planes of the studio's buffers as layers of an EXR.
#pragma once

#include <string>
#include <vector>

#include "gbuffer.h"
#include "image.h"

namespace cli {

// Planes of `buffer` become channels prefix + "R", "G", "B"; a single plane becomes `prefix` itself.
void addLayer(studio::Image& image, const std::string& prefix, const studio::PlanarBuffer& buffer);
// What a PNG shows of a picture: radiance along lobes as it is, else the composite with its irradiance.
studio::Image shownRadiance(const studio::Image& image);
// The planes one after the other, without the padding of their rows.
std::vector<float> packedPlanes(const studio::PlanarBuffer& buffer);
// direct.* (L_d), albedo.*, normal.*: what a composite and a comparison need beside the irradiance.
void addViewLayers(studio::Image& image, const studio::GBuffer& gbuffer);

}  // namespace cli
