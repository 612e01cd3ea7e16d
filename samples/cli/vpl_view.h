// The VPLs that lit a technique's last frame, from its debug view "vpls".
#pragma once

#include <vector>

#include "indirect_renderer.h"
#include "path_tracer.h"

namespace cli {

// The name of the view, by which an instrument knows a VPL technique.
constexpr const char* kVplView = "vpls";
constexpr std::uint32_t kVplChannels = 10;  // position, normal, flux, area

// Those that only fill the last group carry no flux and are left out. UsageError when the technique has
// no such view.
std::vector<studio::VplRecord> readVplView(const IndirectRenderer& renderer);

}  // namespace cli
