#include "vpl_view.h"

#include <fmt/format.h>

#include <stdexcept>

namespace cli {

std::vector<studio::VplRecord> readVplView(const IndirectRenderer& renderer) {
    const DebugPlanes planes = renderer.readDebugView(kVplView);
    if (planes.channels != kVplChannels)
        throw std::runtime_error(fmt::format("debug view {}: expected {} channels, got {}", kVplView,
                                             kVplChannels, planes.channels));
    std::vector<studio::VplRecord> vpls;
    for (std::size_t i = 0; i < std::size_t(planes.width) * planes.height; ++i) {
        const auto vector = [&](std::uint32_t first) {
            return glm::vec3(planes.plane(first)[i], planes.plane(first + 1)[i],
                             planes.plane(first + 2)[i]);
        };
        const studio::VplRecord vpl{vector(0), vector(3), vector(6), planes.plane(9)[i]};
        if (vpl.flux != glm::vec3(0.0f)) vpls.push_back(vpl);
    }
    return vpls;
}

}  // namespace cli
