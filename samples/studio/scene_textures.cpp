// Pictures decoded to 8-bit RGBA by OpenImageIO.
#include <memory>
#include <stdexcept>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "scene_import.h"

namespace studio {
namespace {

Texture readAll(OIIO::ImageInput& input, const std::string& what) {
    const OIIO::ImageSpec& spec = input.spec();
    Texture texture;
    texture.width = spec.width;
    texture.height = spec.height;
    const std::size_t count = std::size_t(spec.width) * std::size_t(spec.height);
    const std::size_t channels = std::size_t(spec.nchannels);
    std::vector<std::uint8_t> pixels(count * channels);
    if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, pixels.data()))
        throw std::runtime_error(fmt::format("{}: {}", what, input.geterror()));
    texture.rgba.resize(count * 4);
    const bool grey = channels < 3, hasAlpha = channels == 2 || channels == 4;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t* p = &pixels[i * channels];
        std::uint8_t* to = &texture.rgba[i * 4];
        for (std::size_t c = 0; c < 3; ++c) to[c] = p[grey ? 0 : c];
        to[3] = hasAlpha ? p[channels - 1] : std::uint8_t(255);
    }
    return texture;
}

// Colours of transparent texels are wanted as they are stored.
OIIO::ImageSpec unassociated() {
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

}  // namespace

Texture decodeTexture(const void* bytes, std::size_t byteCount, const std::string& what) {
    // OpenImageIO picks the reader by the name's extension; the first bytes tell the format.
    const auto* head = static_cast<const unsigned char*>(bytes);
    const bool png = byteCount > 4 && head[0] == 0x89 && head[1] == 'P';
    const bool jpeg = byteCount > 4 && head[0] == 0xFF && head[1] == 0xD8;
    if (!png && !jpeg) throw std::runtime_error(what + ": expected a PNG or JPEG picture");
    OIIO::Filesystem::IOMemReader memory(const_cast<void*>(bytes), byteCount);
    OIIO::ImageSpec config = unassociated();
    void* proxy = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const auto input = OIIO::ImageInput::open(png ? "embedded.png" : "embedded.jpg", &config, &memory);
    if (!input) throw std::runtime_error(fmt::format("{}: {}", what, OIIO::geterror()));
    return readAll(*input, what);
}

Texture readTexture(const std::string& path) {
    const OIIO::ImageSpec config = unassociated();
    const auto input = OIIO::ImageInput::open(path, &config);
    if (!input) throw std::runtime_error(fmt::format("{}: {}", path, OIIO::geterror()));
    return readAll(*input, path);
}

}  // namespace studio
