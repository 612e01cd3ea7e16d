// Float images with named channels, read and written as EXR (scene-linear layers) or PNG (display).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace studio {

// Rows top to bottom; one packed plane of width * height floats per channel, e.g. "R", "direct.G".
// Metadata are EXR string attributes (reference noise, sample counts, scene, camera).
struct Image {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;
    std::map<std::string, std::string> metadata;

    Image() = default;
    Image(int w, int h) : width(w), height(h) {}
    std::size_t pixelCount() const { return std::size_t(width) * std::size_t(height); }
    bool has(const std::string& channel) const { return channels.count(channel) != 0; }
    // Creates the plane, zeroed, when it is missing.
    std::vector<float>& plane(const std::string& channel);
    // Throws std::runtime_error naming the missing channel and those present.
    const std::vector<float>& plane(const std::string& channel) const;
};

// Metadata key that readImage sets on files of integer pixels.
constexpr const char* kDisplayReferredKey = "displayReferred";

// Errors: std::runtime_error naming the path and the library's reason. Files of integer pixels (PNG) are
// taken as sRGB-encoded and come out linear in R, G, B, marked with kDisplayReferredKey; string
// attributes become metadata.
Image readImage(const std::string& path);
// `half`: 16-bit float channels (references shipped in the tree); throws on a value beyond 65504.
// The same image gives the same bytes. Metadata with an empty value are not stored; keys that EXR uses
// itself (and any with a colon) throw.
void writeExr(const std::string& path, const Image& image, bool half = false);
// 8-bit sRGB PNG of a display-referred linear image's R, G, B; throws on a value outside [0,1].
void writePng(const std::string& path, const Image& image);
// The same as JPEG, for reports; `quality` 1 ... 100.
void writeJpeg(const std::string& path, const Image& image, int quality);

// The sRGB transfer function (IEC 61966-2-1) and its inverse, on [0,1].
float srgbEncode(float linear);
float srgbDecode(float encoded);

// Composite L = L_d + albedo / pi * E of an image with layers R,G,B (irradiance), direct.*, albedo.*.
Image composite(const Image& image);
// Reinhard's global operator L / (1 + L) per channel after `exposure`; display-referred linear [0,1].
// Negative radiance becomes 0, infinity 1; NaN stays NaN.
Image toneMap(const Image& radiance, float exposure = 1.0f);
// One exposure for a set of pictures: maps the log-average luminance of `radiance` (black pixels left
// out) to 0.18. 1 for a black picture; throws on NaN or infinity.
float autoExposure(const Image& radiance);

}  // namespace studio
