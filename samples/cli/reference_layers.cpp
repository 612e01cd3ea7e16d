#include "reference_layers.h"

namespace cli {
namespace {

void addTo(studio::Image& to, const std::string& prefix, const studio::Image& from,
           const std::string& layer) {
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& sum = to.plane(prefix + channel);
        const std::vector<float>& values = from.plane(layer + "." + channel);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
    }
}

}  // namespace

studio::Image assembleReference(const studio::Image& traced, const std::vector<std::string>& chosen,
                                bool isCompact) {
    studio::Image image(traced.width, traced.height);
    image.metadata = traced.metadata;
    for (const std::string& layer : chosen) addTo(image, "", traced, layer);
    if (isCompact) return image;
    for (const std::string& layer : chosen)
        for (const std::string half : {"a.", "b."})
            if (traced.has(half + layer + ".R")) addTo(image, half + layer + ".", traced, half + layer);
    for (const std::string layer : {"direct", "bounce1", "bounce2", "all", "ambient", "specular"})
        if (traced.has(layer + ".R"))
            addTo(image, layer == "direct" ? "direct_irradiance." : layer + ".", traced, layer);
    if (traced.has("validity")) image.plane("validity") = traced.plane("validity");
    return image;
}

}  // namespace cli
