#include "techniques/static_vpl_phantoms.h"

#include <algorithm>

#include "compute/device.h"
#include "inputs/camera.h"
#include "inputs/image_check.h"

namespace lightwell {
namespace {

bool isSpot(const LWLight& light) {
    return light.kind == LW_LIGHT_SPOT;
}
bool byMap(const LWLight& light) {
    return isSpot(light) && !light.hit && light.rsmCount > 0;
}

// The frame's lights with those maps only that a phantom's place comes from.
std::vector<LWLight> lightsByMap(const LWFrame& frame) {
    std::vector<LWLight> lights(frame.lights, frame.lights + frame.lightCount);
    for (LWLight& light : lights)
        if (!byMap(light)) light.rsmCount = 0;
    return lights;
}

// The texel in the middle, as an image of its own.
LWImage middleOf(Device& device, const LWImage& image, const ImageRole& role, const std::string& name) {
    if (imageAbsent(image)) return image;
    const CheckedImage checked = checkImage(device, image, role, image.width, image.height, name);
    LWImage middle = image;
    middle.byteOffset = std::uint64_t(std::int64_t(checked.pixels.byteOffset) +
                                      std::int64_t(image.height / 2) * checked.pixels.byteRowStride +
                                      std::int64_t(image.width / 2) * checked.pixels.bytePixelStride);
    middle.bytePixelStride = checked.pixels.bytePixelStride;
    middle.byteRowStride = 0;
    middle.bytePlaneStride = checked.pixels.bytePlaneStride;
    middle.width = middle.height = 1;
    return middle;
}

}  // namespace

void StaticVplPhantoms::check(Device& device, const LWFrame& frame) const {
    if (!wanted_) return;
    const std::vector<LWLight> lights = lightsByMap(frame);
    LWFrame maps = frame;
    maps.lights = lights.data();
    RsmInput::check(device, maps);
}

// Of a map only its middle is read. As an image of one texel it lies exactly on the camera's axis, also
// where it has an even number of texels and none of them does: depth leads to a place on the axis.
void StaticVplPhantoms::import(Executor& executor, const LWFrame& frame) {
    const std::vector<lw_phantom> before = std::move(phantoms_);
    phantoms_.clear();
    fromMaps_ = changed_ = false;
    if (!wanted_) return;
    std::vector<LWLight> lights = lightsByMap(frame);
    std::vector<LWRsm> rsms(lights.size());
    for (std::size_t l = 0; l < lights.size(); ++l) {
        if (lights[l].rsmCount == 0) continue;
        const std::string name = "frame.lights[" + std::to_string(l) + "].rsms[0]";
        rsms[l] = lights[l].rsms[0];
        rsms[l].position =
            middleOf(executor.device(), rsms[l].position, kPositionRole, name + ".position");
        rsms[l].depth = middleOf(executor.device(), rsms[l].depth, kDepthRole, name + ".depth");
        rsms[l].normal = middleOf(executor.device(), rsms[l].normal, kNormalRole, name + ".normal");
        rsms[l].flux = middleOf(executor.device(), rsms[l].flux, kRadianceRole, name + ".flux");
        lights[l].rsms = &rsms[l];
        fromMaps_ = true;
    }
    LWFrame middles = frame;
    middles.lights = lights.data();
    if (fromMaps_) rsms_.import(executor, middles);
    std::size_t span = 0;
    for (std::uint32_t l = 0; l < frame.lightCount; ++l) {
        const LWLight& light = frame.lights[l];
        if (!isSpot(light) || !(light.hit || light.rsmCount)) continue;
        lw_phantom phantom{};
        phantom.light = cl_int(l);
        if (light.hit)
            phantom.hit = float4(light.hit[0], light.hit[1], light.hit[2], 1.0);
        else
            phantom.texel = cl_int(rsms_.spans[span++].firstTexel);
        phantoms_.push_back(phantom);
    }
    changed_ = !std::equal(before.begin(), before.end(), phantoms_.begin(), phantoms_.end(),
                           [](const lw_phantom& a, const lw_phantom& b) { return a.light == b.light; });
}

std::vector<LWChoice> StaticVplPhantoms::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices;
    if (!wanted_) return choices;
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (isSpot(frame.lights[l]) && !frame.lights[l].hit && frame.lights[l].rsmCount == 0) {
            choices.push_back({"frame.lights",
                               "some spot lights have neither hit nor RSM: they light the static VPLs, "
                               "not a phantom"});
            break;
        }
    return choices;
}

std::uint64_t StaticVplPhantoms::estimateBytes(const FrameShape& shape) {
    FrameShape middles;
    middles.uploads = shape.uploads;
    for (std::uint32_t i = 0; i < shape.aimedBySpotMaps; ++i) middles.addMap(1, 1);
    return shape.aimedBySpotMaps ? RsmInput::estimateBytes(middles) : 0;
}

}  // namespace lightwell
