#include "planted_inputs.h"

#include "lightwell/lightwell.hpp"

namespace cli {
namespace {

using Pixels = PlantedInputs::Pixels;

Pixels copyOf(const LWImage& image) {
    Pixels copy;
    copy.width = int(image.width);
    copy.height = int(image.height);
    copy.channels = image.format == LW_FORMAT_FLOAT1          ? 1
                    : image.format == LW_FORMAT_PLANAR_FLOAT2 ? 2
                                                              : 3;
    copy.values.resize(std::size_t(copy.width) * std::size_t(copy.height) * std::size_t(copy.channels));
    for (int c = 0; c < copy.channels; ++c)
        for (int y = 0; y < copy.height; ++y) {
            const float* row =
                reinterpret_cast<const float*>(static_cast<const char*>(image.host) +
                                               c * image.bytePlaneStride + y * image.byteRowStride);
            for (int x = 0; x < copy.width; ++x) copy.at(x, y)[c] = row[x];
        }
    return copy;
}
}  // namespace

LWImage PlantedInputs::Pixels::image() const {
    constexpr LWFormat kFormats[] = {LW_FORMAT_FLOAT1, LW_FORMAT_FLOAT2, LW_FORMAT_FLOAT3};
    LWImage image{};
    if (values.empty()) return image;
    image.host = values.data();
    image.format = kFormats[channels - 1];
    image.width = std::uint32_t(width);
    image.height = std::uint32_t(height);
    return image;
}

PlantedInputs::PlantedInputs(const RenderInputs& inputs)
    : position(copyOf(inputs.lwGBuffer().position)),
      normal(copyOf(inputs.lwGBuffer().normal)),
      albedo(copyOf(inputs.lwGBuffer().albedo)),
      direct(copyOf(inputs.lwGBuffer().directRadiance)),
      motion(copyOf(inputs.lwGBuffer().motion)),
      gbuffer(inputs.lwGBuffer()),
      lights(inputs.lights()) {
    for (const LWLight& light : lights) {
        rsms.emplace_back(light.rsms, light.rsms + light.rsmCount);
        maps.emplace_back();
        for (const LWRsm& rsm : rsms.back())
            maps.back().push_back({copyOf(rsm.position), copyOf(rsm.normal), copyOf(rsm.flux)});
    }
    std::copy_n(inputs.environment(), 3, environment);
    describe();
}

void PlantedInputs::describe() {
    gbuffer.position = depth.values.empty() ? position.image() : LWImage{};
    gbuffer.depth = depth.image();
    gbuffer.normal = normal.image();
    gbuffer.albedo = albedo.image();
    gbuffer.directRadiance = direct.image();
    gbuffer.motion = motion.image();
    for (std::size_t l = 0; l < lights.size(); ++l) {
        for (std::size_t r = 0; r < maps[l].size(); ++r) {
            rsms[l][r].position = maps[l][r].position.image();
            rsms[l][r].normal = maps[l][r].normal.image();
            rsms[l][r].flux = maps[l][r].flux.image();
        }
        lights[l].rsms = rsms[l].data();
    }
}

LWFrame PlantedInputs::frame() const {
    LWFrame result = lightwell::make<LWFrame>();
    result.lights = lights.data();
    result.lightCount = std::uint32_t(lights.size());
    std::copy_n(environment, 3, result.environment);
    return result;
}
}  // namespace cli
