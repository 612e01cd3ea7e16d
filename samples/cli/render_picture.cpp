#include "render_picture.h"

#include <cstring>

#include <fmt/format.h>

#include "cli.h"
#include "layers.h"

namespace cli {

std::uint64_t hashBits(const studio::PlanarBuffer& buffer) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (int plane = 0; plane < buffer.planes(); ++plane)
        for (int y = 0; y < buffer.height(); ++y)
            for (int x = 0; x < buffer.width(); ++x) {
                std::uint32_t bits = 0;
                std::memcpy(&bits, buffer.row(plane, y) + x, sizeof bits);
                for (int byte = 0; byte < 4; ++byte)
                    hash = (hash ^ ((bits >> (8 * byte)) & 0xffu)) * 0x100000001b3u;
            }
    return hash;
}

void writeDebugView(const IndirectRenderer& renderer, const std::string& argument) {
    const auto [name, path] = splitAssignment("--debug-view", argument);
    const DebugPlanes planes = renderer.readDebugView(name);
    studio::Image image(int(planes.width), int(planes.height));
    for (std::uint32_t c = 0; c < planes.channels; ++c)
        image.plane(fmt::format("c{:02}", c))
            .assign(planes.plane(c), planes.plane(c) + image.pixelCount());
    studio::writeExr(path, image);
}

studio::Image assemblePicture(const RenderInputs& inputs, const studio::PlanarBuffer& irradiance,
                              const studio::PlanarBuffer& validity, Quantity quantity,
                              const RenderReport& report) {
    studio::Image image(report.size.width, report.size.height);
    addLayer(image, "", irradiance);
    if (quantity == Quantity::Irradiance) addLayer(image, "validity", validity);
    addViewLayers(image, inputs.gbuffer());
    image.metadata = {{"layer", entryOf(quantity).layer},
                      {"scene", report.scene},
                      {"camera", report.camera},
                      {"technique", report.technique}};
    if (report.hasDevice) image.metadata["device"] = report.device.name;
    for (const auto& [name, value] : report.parameters)
        image.metadata["set." + name] =
            std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
    return image;
}

}  // namespace cli
