#include "frame_vpls.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "vpl_placement.h"

namespace cli {
namespace {

constexpr std::uint32_t kAllReceivers = LW_RECEIVERS_UNBAKED | LW_RECEIVERS_BAKED;

void copyVector(const glm::vec3& from, float (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// False: one that stands for nothing, or that no light lights, or whose light nobody gets.
bool describe(const studio::StaticVpl& from, float areaPerWeight, LWStaticVpl& to) {
    to = LWStaticVpl{};
    copyVector(from.position, to.position);
    copyVector(from.normal, to.normal);
    copyVector(from.reflectance, to.reflectance);
    to.weight = from.weight ? *from.weight * areaPerWeight : 0.0f;
    to.lightMask = from.lightMask;
    to.receivers = from.receiverMask & kAllReceivers;
    return to.lightMask != 0 && to.receivers != 0 && (!from.weight || to.weight > 0.0f);
}

}  // namespace

FrameVpls::FrameVpls(const std::string& file, const RenderInputs& inputs)
    : source_(studio::readStaticVpls(file)) {
    source_.metresPerUnit *= inputs.scale();  // positions, radii and, squared, areas
}

FrameVpls::FrameVpls(const RenderInputs& inputs, std::uint32_t cap) {
    studio::PlacementOptions options;
    if (cap != 0) options.cap = int(cap);
    for (const studio::Light& light : inputs.scene().lights())
        if (light.kind != studio::LightKind::Sun) options.from.push_back(light.position);
    if (options.from.empty()) options.from.push_back(inputs.gbuffer().camera.position);
    try {
        source_ = studio::placeVpls(inputs.scene(), options, {}).vpls;
    } catch (const std::runtime_error& error) {
        fmt::print(stderr,
                   "static_vpl: no VPLs without --set vpls_file=FILE, as none can be placed here: {}\n",
                   error.what());
    }
}

void FrameVpls::fill(const RenderInputs& inputs, LWFrame& frame) {
    const studio::StaticVpls posed = studio::posedVpls(source_, inputs.scene().scene(), inputs.time());
    vpls_.clear();
    blockers_.clear();
    for (const studio::StaticVpl& vpl : posed.vpls)
        if (LWStaticVpl described; describe(vpl, posed.areaPerWeight, described))
            vpls_.push_back(described);
    for (const studio::StaticBlocker& blocker : posed.blockers) {
        LWBlocker described{};
        copyVector(blocker.center, described.center);
        described.radius = blocker.radius;
        blockers_.push_back(described);
    }
    frame.staticVpls = vpls_.data();
    frame.staticVplCount = std::uint32_t(vpls_.size());
    frame.blockers = blockers_.data();
    frame.blockerCount = std::uint32_t(blockers_.size());
}

}  // namespace cli
