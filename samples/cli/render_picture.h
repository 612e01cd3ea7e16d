// The picture that `lightwell render` makes: its layers, its hash, and intermediate buffers.
#pragma once

#include <cstdint>
#include <string>

#include "image.h"
#include "indirect_renderer.h"
#include "render_report.h"

namespace cli {

// FNV-1a over the bits of the pixels, padding left out: equal hashes, equal pictures.
std::uint64_t hashBits(const studio::PlanarBuffer& buffer);

// `argument` is NAME=FILE.exr; the channels c00, c01, ... of an intermediate buffer.
void writeDebugView(const IndirectRenderer& renderer, const std::string& argument);

// The technique's planes beside the view's own layers; of irradiance alone with validity.
studio::Image assemblePicture(const RenderInputs& inputs, const studio::PlanarBuffer& irradiance,
                              const studio::PlanarBuffer& validity, Quantity quantity,
                              const RenderReport& report);

}  // namespace cli
