// What a host's image must satisfy before any kernel touches it. Every refusal names the image, what was
// expected and what came.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "lightwell/lightwell.h"
#include "shared/pixel_formats.h"

namespace lightwell {

class Device;

using FormatSet = std::uint32_t;  // bit per LWFormat
constexpr FormatSet formatBit(LWFormat format) {
    return 1u << unsigned(format);
}
constexpr FormatSet formatSet(std::initializer_list<LWFormat> formats) {
    FormatSet set = 0;
    for (LWFormat format : formats) set |= formatBit(format);
    return set;
}

// What an image is for.
struct ImageRole {
    std::uint32_t channels;  // 1, 2 or 3
    FormatSet formats;
    int decode = LW_ROLE_VALUE;
    bool written = false;
};
extern const ImageRole kPositionRole, kDepthRole, kNormalRole, kAlbedoRole, kRadianceRole, kScalarRole,
    kMotionRole, kMaskRole, kOutputColourRole, kOutputScalarRole;

// The most bytes of a pixel, without gaps, that an image of this role can have.
std::uint32_t largestPixelBytes(const ImageRole& role);

// True when nothing in the image is set.
bool imageAbsent(const LWImage& image);

// An image that passed: strides made explicit, and the bytes that its pixels span.
struct CheckedImage {
    LWImage image;  // the host's, as it came
    LwPixels pixels;
    std::uint64_t firstByte, endByte;  // from the start of memory
    std::uint32_t pixelBytes, planes;  // bytes of a pixel in one plane; planes of the format
    // Rows of whole groups of 16 float32 on 64-byte borders, planes apart: usable as planes as it
    // stands, with the padding of the last row in `paddedEndByte`.
    bool planesLayout;
    std::uint64_t paddedEndByte;
};

// `width`, `height`: the size it must have. Throws INVALID_ARGUMENT.
CheckedImage checkImage(Device& device, const LWImage& image, const ImageRole& role, std::uint32_t width,
                        std::uint32_t height, const std::string& name);

}  // namespace lightwell
