// A technique of the library on another program's frame.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_frame.h"
#include "image.h"
#include "indirect_renderer.h"
#include "parameters.h"
#include "render_report.h"

namespace cli {

struct GiLight {
    studio::PlanarBuffer irradiance, validity;  // W/m^2; share of the hemisphere accounted for
};

// UsageError where `technique` cannot light such a frame whatever it holds: what it needs of a scene, an EXR does not have.
void requireFrameTechnique(const Parameters& parameters);

// Renders `frames` frames of one and the same picture; what is returned, and figures in `report`, are the last one's. What the library refuses is
// a UsageError. `findings`: what lwCheckInputs says, where wanted.
GiLight renderGi(const HostFrame& frame, const Parameters& parameters, const DeviceOptions& options, int frames, RenderReport& report,
                 std::vector<LWInputFinding>* findings);

// The host's own irradiance: the mean of these files, which are independent pictures of one thing (layers irradiance or indirect-uncoloured).
// Of two, each is a half: `image` gets them as layers a.* and b.*, by which `lightwell compare` knows their noise.
studio::PlanarBuffer readTruth(const std::vector<std::string>& paths, const ChannelMap& channels, const HostSurfaces& view, studio::Image& image);

}  // namespace cli
