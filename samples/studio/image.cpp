// Reading and writing of EXR and PNG through OpenImageIO, and the display transform.
//
// EXR: every channel by its name ("R", "direct.G"), 32- or 16-bit float, ZIP compression; metadata are
// string attributes. Files of integer pixels (PNG, JPEG) are taken as sRGB-encoded and decoded.
// Tone mapping: Reinhard et al. 2002, "Photographic tone reproduction for digital images", eq. 1-3.
#include "image.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <stdexcept>

namespace studio {
namespace {

constexpr float kPi = 3.14159265358979323846f;
constexpr float kLargestHalf = 65504.0f;
constexpr std::array<const char*, 3> kRgb{"R", "G", "B"};

std::string channelList(const Image& image) {
    std::string list;
    for (const auto& channel : image.channels) list += (list.empty() ? "" : ", ") + channel.first;
    return list.empty() ? "none" : list;
}

// A picture that can be written: a size, at least one channel, each of width * height floats.
void checkWritable(const std::string& path, const Image& image) {
    if (image.width < 1 || image.height < 1)
        throw std::runtime_error(fmt::format("{}: expected an image of at least 1x1 pixels, got {}x{}",
                                             path, image.width, image.height));
    if (image.channels.empty()) throw std::runtime_error(path + ": the image has no channels to write");
    for (const auto& [name, values] : image.channels)
        if (values.size() != image.pixelCount())
            throw std::runtime_error(fmt::format("{}: channel {} has {} values, expected {}x{} = {}",
                                                 path, name, values.size(), image.width, image.height,
                                                 image.pixelCount()));
}

// Half floats end at 65504; a larger value would turn into infinity without a word.
void checkFitsHalf(const std::string& path, const Image& image) {
    for (const auto& [name, values] : image.channels)
        for (float value : values)
            if (std::isfinite(value) && std::abs(value) > kLargestHalf)
                throw std::runtime_error(fmt::format(
                    "{}: {} in channel {} is beyond the largest half float, {}; write full floats", path,
                    value, name, kLargestHalf));
}

template <class T>
void writeInterleaved(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                      const std::vector<T>& pixels) {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
    if (!output) throw std::runtime_error(path + ": cannot write: " + OIIO::geterror());
    if (!output->open(path, spec))
        throw std::runtime_error(path + ": cannot open for writing: " + output->geterror());
    if (!output->write_image(type, pixels.data()) || !output->close())
        throw std::runtime_error(path + ": cannot write: " + output->geterror());
}

// Names that EXR or OpenImageIO give a meaning or another type, so that a string of ours wouldn't come
// back. On reading they are left out: they'd pile up over read and write.
bool isFormatAttribute(const std::string& name) {
    static const std::set<std::string> kNames = {"capDate",
                                                 "channels",
                                                 "chunkCount",
                                                 "comments",
                                                 "compression",
                                                 "dataWindow",
                                                 "DateTime",
                                                 "description",
                                                 "displayWindow",
                                                 "lineOrder",
                                                 "owner",
                                                 "pixelAspectRatio",
                                                 "screenWindowCenter",
                                                 "screenWindowWidth",
                                                 "Software",
                                                 "tiles",
                                                 "type",
                                                 "worldToCamera",
                                                 "worldToNDC",
                                                 "xDensity"};
    return name.find(':') != std::string::npos || kNames.count(name) != 0;
}

// Decodes a file of integer pixels in place: grey becomes R, G, B; alpha stays linear.
void decodeDisplayFile(Image& image) {
    image.metadata[kDisplayReferredKey] = "sRGB";
    if (image.has("Y") && !image.has("R")) {
        for (const char* name : kRgb) image.channels[name] = image.channels["Y"];
        image.channels.erase("Y");
    }
    for (const char* name : kRgb)
        if (image.has(name))
            for (float& value : image.channels[name]) value = srgbDecode(value);
}

}  // namespace

std::vector<float>& Image::plane(const std::string& channel) {
    const auto [entry, isNew] = channels.try_emplace(channel);
    if (isNew) entry->second.assign(pixelCount(), 0.0f);
    return entry->second;
}

const std::vector<float>& Image::plane(const std::string& channel) const {
    const auto entry = channels.find(channel);
    if (entry == channels.end())
        throw std::runtime_error(
            fmt::format("missing channel {}; present: {}", channel, channelList(*this)));
    return entry->second;
}

Image readImage(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) throw std::runtime_error(path + ": cannot read: " + OIIO::geterror());
    const OIIO::ImageSpec spec = input->spec();
    if (spec.deep || spec.depth > 1)
        throw std::runtime_error(path + ": expected a flat image, got a deep or volume image");
    if (input->seek_subimage(1, 0))
        throw std::runtime_error(path + ": expected one image, got a file of several parts");

    Image image(spec.width, spec.height);
    const std::size_t channelCount = std::size_t(spec.nchannels);
    std::vector<float> pixels(image.pixelCount() * channelCount);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, pixels.data()))
        throw std::runtime_error(path + ": cannot read: " + input->geterror());
    for (std::size_t c = 0; c < channelCount; ++c) {
        std::vector<float>& plane = image.plane(spec.channelnames[c]);
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = pixels[i * channelCount + c];
    }
    for (const OIIO::ParamValue& attribute : spec.extra_attribs)
        if (attribute.type() == OIIO::TypeString && !isFormatAttribute(attribute.name().string()))
            image.metadata[attribute.name().string()] = attribute.get_string();
    if (!spec.format.is_floating_point()) decodeDisplayFile(image);
    return image;
}

void writeExr(const std::string& path, const Image& image, bool half) {
    checkWritable(path, image);
    if (half) checkFitsHalf(path, image);
    const std::size_t channelCount = image.channels.size();
    OIIO::ImageSpec spec(image.width, image.height, int(channelCount),
                         half ? OIIO::TypeHalf : OIIO::TypeFloat);
    spec.channelnames.clear();
    std::vector<float> pixels(image.pixelCount() * channelCount);
    std::size_t c = 0;
    for (const auto& [name, values] : image.channels) {
        spec.channelnames.push_back(name);
        for (std::size_t i = 0; i < values.size(); ++i) pixels[i * channelCount + c] = values[i];
        ++c;
    }
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the time of writing: the same image must give the same bytes
    for (const auto& [key, value] : image.metadata) {
        if (key.empty() || isFormatAttribute(key))
            throw std::runtime_error(
                fmt::format("{}: metadata key \"{}\" belongs to the file format", path, key));
        spec.attribute(key, value);
    }
    writeInterleaved(path, spec, OIIO::TypeFloat, pixels);
}

namespace {

// sRGB codes of a display picture, interleaved.
std::vector<std::uint8_t> encodePixels(const std::string& path, const Image& image) {
    checkWritable(path, image);
    std::vector<std::uint8_t> pixels(image.pixelCount() * 3);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float>& plane = image.plane(kRgb[c]);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            if (!(plane[i] >= 0.0f && plane[i] <= 1.0f))  // written so that NaN fails, too
                throw std::runtime_error(fmt::format(
                    "{}: expected display values in [0,1], got {} in {} at pixel ({}, {})", path,
                    plane[i], kRgb[c], i % std::size_t(image.width), i / std::size_t(image.width)));
            pixels[i * 3 + c] = std::uint8_t(std::lround(255.0f * srgbEncode(plane[i])));
        }
    }
    return pixels;
}

OIIO::ImageSpec displaySpec(const Image& image) {
    OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    return spec;
}

}  // namespace

void writePng(const std::string& path, const Image& image) {
    writeInterleaved(path, displaySpec(image), OIIO::TypeUInt8, encodePixels(path, image));
}

void writeJpeg(const std::string& path, const Image& image, int quality) {
    OIIO::ImageSpec spec = displaySpec(image);
    spec.attribute("compression", fmt::format("jpeg:{}", quality));
    writeInterleaved(path, spec, OIIO::TypeUInt8, encodePixels(path, image));
}

float srgbEncode(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float srgbDecode(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Image composite(const Image& image) {
    Image result(image.width, image.height);
    for (const std::string name : kRgb) {
        const std::vector<float>& irradiance = image.plane(name);
        const std::vector<float>& direct = image.plane("direct." + name);
        const std::vector<float>& albedo = image.plane("albedo." + name);
        std::vector<float>& radiance = result.plane(name);
        for (std::size_t i = 0; i < radiance.size(); ++i)
            radiance[i] = direct[i] + albedo[i] / kPi * irradiance[i];
    }
    return result;
}

Image toneMap(const Image& radiance, float exposure) {
    if (!(exposure > 0.0f) || !std::isfinite(exposure))
        throw std::runtime_error(
            fmt::format("toneMap: expected a positive finite exposure, got {}", exposure));
    Image result(radiance.width, radiance.height);
    for (const char* name : kRgb) {
        const std::vector<float>& from = radiance.plane(name);
        std::vector<float>& to = result.plane(name);
        for (std::size_t i = 0; i < to.size(); ++i) {
            // A display can't emit less than nothing: filters that undershoot show as black. NaN stays
            // NaN.
            const float exposed = from[i] < 0.0f ? 0.0f : exposure * from[i];
            to[i] = std::isinf(exposed) ? 1.0f : exposed / (1.0f + exposed);
        }
    }
    return result;
}

float autoExposure(const Image& radiance) {
    constexpr double kKey = 0.18;
    // Darker pixels count as this share of the mean: a few nearly black ones must not decide.
    constexpr double kDarkest = 1e-4;
    const std::vector<float>&r = radiance.plane("R"), &g = radiance.plane("G"), &b = radiance.plane("B");
    std::vector<double> lit;  // luminances (Rec. 709) of all pixels but black ones
    double sum = 0.0;
    for (std::size_t i = 0; i < r.size(); ++i) {
        const double luminance = 0.2126 * double(r[i]) + 0.7152 * double(g[i]) + 0.0722 * double(b[i]);
        if (!std::isfinite(luminance))
            throw std::runtime_error(fmt::format("autoExposure: pixel ({}, {}) is not finite",
                                                 i % std::size_t(radiance.width),
                                                 i / std::size_t(radiance.width)));
        if (luminance <= 0.0) continue;
        lit.push_back(luminance);
        sum += luminance;
    }
    if (lit.empty()) return 1.0f;  // a black picture stays black under any exposure
    const double darkest = kDarkest * sum / double(lit.size());
    double logSum = 0.0;
    for (double luminance : lit) logSum += std::log(std::max(luminance, darkest));
    return float(kKey / std::exp(logSum / double(lit.size())));
}

}  // namespace studio
