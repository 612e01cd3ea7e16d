#include "layers.h"

#include <algorithm>

namespace cli {

void addLayer(studio::Image& image, const std::string& prefix, const studio::PlanarBuffer& buffer) {
    const char* channels = "RGB";
    for (int plane = 0; plane < buffer.planes(); ++plane) {
        std::vector<float>& to = image.plane(buffer.planes() == 1 ? prefix : prefix + channels[plane]);
        for (int y = 0; y < buffer.height(); ++y)
            std::copy_n(buffer.row(plane, y), buffer.width(),
                        to.data() + std::ptrdiff_t(y) * buffer.width());
    }
}

studio::Image shownRadiance(const studio::Image& image) {
    const auto layer = image.metadata.find("layer");
    if (layer == image.metadata.end() || (layer->second != "specular" && layer->second != "refracted"))
        return studio::composite(image);
    studio::Image shown(image.width, image.height);
    for (const char* channel : {"R", "G", "B"}) shown.plane(channel) = image.plane(channel);
    return shown;
}

std::vector<float> packedPlanes(const studio::PlanarBuffer& buffer) {
    std::vector<float> values;
    for (int plane = 0; plane < buffer.planes(); ++plane)
        for (int y = 0; y < buffer.height(); ++y)
            values.insert(values.end(), buffer.row(plane, y), buffer.row(plane, y) + buffer.width());
    return values;
}

void addViewLayers(studio::Image& image, const studio::GBuffer& gbuffer) {
    addLayer(image, "direct.", gbuffer.direct);
    addLayer(image, "albedo.", gbuffer.albedo);
    addLayer(image, "normal.", gbuffer.normal);
}

}  // namespace cli
