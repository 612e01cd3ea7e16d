#include "inputs/image_check.h"

#include <algorithm>

#include "compute/buffer.h"
#include "compute/cl.h"
#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "inputs/host_memory.h"

namespace lightwell {
namespace {

// Larger strides and offsets are garbage; below them no sum over 16384 pixels, rows and 3 planes leaves
// 64 bits.
constexpr std::int64_t kLargestStride = std::int64_t(1) << 40;
constexpr std::uint64_t kLargestOffset = std::uint64_t(1) << 46;
// What kernels address in an image in place: int offsets of floats.
constexpr std::int64_t kLargestFloatIndex = 0x7fffffff;

static_assert(LW_PIXEL_FLOAT1 == LW_FORMAT_FLOAT1 && LW_PIXEL_FLOAT2 == LW_FORMAT_FLOAT2 &&
                  LW_PIXEL_FLOAT3 == LW_FORMAT_FLOAT3 && LW_PIXEL_FLOAT4 == LW_FORMAT_FLOAT4 &&
                  LW_PIXEL_HALF4 == LW_FORMAT_HALF4 && LW_PIXEL_UNORM8X4 == LW_FORMAT_UNORM8X4 &&
                  LW_PIXEL_UNORM8X4_SRGB == LW_FORMAT_UNORM8X4_SRGB &&
                  LW_PIXEL_OCT16X2 == LW_FORMAT_OCT16X2 &&
                  LW_PIXEL_PLANAR_FLOAT2 == LW_FORMAT_PLANAR_FLOAT2 &&
                  LW_PIXEL_PLANAR_FLOAT3 == LW_FORMAT_PLANAR_FLOAT3 && LW_PIXEL_UINT8 == LW_FORMAT_UINT8,
              "kernels/shared/pixel_formats.h differs from lightwell.h");

struct FormatFacts {
    const char* name;
    std::uint32_t pixelBytes;    // of one plane
    std::uint32_t elementBytes;  // alignment
    std::uint32_t planes;
};
constexpr FormatFacts kFormats[] = {
    {"LW_FORMAT_NONE", 0, 1, 0},          {"LW_FORMAT_FLOAT1", 4, 4, 1},
    {"LW_FORMAT_FLOAT2", 8, 4, 1},        {"LW_FORMAT_FLOAT3", 12, 4, 1},
    {"LW_FORMAT_FLOAT4", 16, 4, 1},       {"LW_FORMAT_HALF4", 8, 2, 1},
    {"LW_FORMAT_UNORM8X4", 4, 1, 1},      {"LW_FORMAT_UNORM8X4_SRGB", 4, 1, 1},
    {"LW_FORMAT_OCT16X2", 4, 2, 1},       {"LW_FORMAT_PLANAR_FLOAT2", 4, 4, 2},
    {"LW_FORMAT_PLANAR_FLOAT3", 4, 4, 3}, {"LW_FORMAT_UINT8", 1, 1, 1},
};
constexpr unsigned kFormatCount = sizeof kFormats / sizeof kFormats[0];

std::string listFormats(FormatSet set) {
    std::string list;
    for (unsigned format = 0; format < kFormatCount; ++format)
        if (set & (1u << format))
            list += (list.empty() ? "" : ", ") + std::string(kFormats[format].name);
    return list;
}

void checkFormat(const LWImage& image, const ImageRole& role, const std::string& name) {
    const std::uint32_t format = rawEnum(image.format);
    if (format < kFormatCount && (role.formats & (1u << format))) return;
    const std::string got = format < kFormatCount ? kFormats[format].name : std::to_string(format);
    fail(LW_ERROR_INVALID_ARGUMENT, name, ".format: expected one of ", listFormats(role.formats),
         ", got ", got);
}

void checkAligned(std::int64_t value, std::uint32_t alignment, const std::string& name,
                  const char* field) {
    if (value % std::int64_t(alignment) != 0)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".", field, ": expected a multiple of ", alignment,
             " bytes for this format, got ", value);
}

void checkStride(std::int64_t value, std::int64_t atLeast, const std::string& name, const char* field) {
    if (value < atLeast || value > kLargestStride)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".", field, ": expected ", atLeast, " .. ", kLargestStride,
             " bytes, got ", value);
}

// Fills in strides left at zero and checks all of them.
LwPixels resolveLayout(const LWImage& image, const ImageRole& role, const std::string& name) {
    const FormatFacts& facts = kFormats[image.format];
    const std::int64_t width = image.width, height = image.height;
    if (image.byteOffset > kLargestOffset)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".byteOffset: expected at most ", kLargestOffset, ", got ",
             image.byteOffset);
    LwPixels pixels{};
    pixels.byteOffset = std::int64_t(image.byteOffset);
    pixels.bytePixelStride =
        image.bytePixelStride ? image.bytePixelStride : std::int64_t(facts.pixelBytes);
    checkStride(pixels.bytePixelStride, facts.pixelBytes, name, "bytePixelStride");
    const std::int64_t rowBytes = (width - 1) * pixels.bytePixelStride + facts.pixelBytes;
    pixels.byteRowStride = image.byteRowStride ? image.byteRowStride : width * pixels.bytePixelStride;
    if (pixels.byteRowStride < -kLargestStride)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".byteRowStride: expected at least ", -kLargestStride,
             ", got ", pixels.byteRowStride);
    const std::int64_t rowStride =
        pixels.byteRowStride < 0 ? -pixels.byteRowStride : pixels.byteRowStride;
    if (height > 1 && rowStride < rowBytes)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".byteRowStride: expected a magnitude of at least ",
             rowBytes, " bytes for ", width, " pixels, got ", pixels.byteRowStride);
    checkStride(rowStride, 1, name, "byteRowStride");
    if (facts.planes > 1) {
        pixels.bytePlaneStride = image.bytePlaneStride ? image.bytePlaneStride : height * rowStride;
        // Planes one after the other, or the planes' rows side by side.
        const std::int64_t planeBytes = (height - 1) * rowStride + rowBytes;
        const bool sideBySide =
            pixels.bytePlaneStride >= rowBytes && pixels.bytePlaneStride <= kLargestStride &&
            (std::int64_t(facts.planes) - 1) * pixels.bytePlaneStride + rowBytes <= rowStride;
        if (!sideBySide) checkStride(pixels.bytePlaneStride, planeBytes, name, "bytePlaneStride");
    } else {
        pixels.bytePlaneStride = facts.elementBytes;  // from channel to channel
    }
    checkAligned(pixels.byteOffset, facts.elementBytes, name, "byteOffset");
    checkAligned(pixels.bytePixelStride, facts.elementBytes, name, "bytePixelStride");
    checkAligned(pixels.byteRowStride, facts.elementBytes, name, "byteRowStride");
    checkAligned(pixels.bytePlaneStride, facts.elementBytes, name, "bytePlaneStride");
    pixels.width = std::int32_t(width);
    pixels.height = std::int32_t(height);
    pixels.format = image.format;
    pixels.channels = std::int32_t(role.channels);
    return pixels;
}

void checkMemoryObject(Device& device, const CheckedImage& checked, bool written,
                       const std::string& name) {
    cl_mem memory = static_cast<cl_mem>(checked.image.clMem);
    cl_context context = nullptr;
    cl_mem_object_type type = 0;
    cl_mem_flags flags = 0;
    std::size_t bytes = 0;
    if (clGetMemObjectInfo(memory, CL_MEM_CONTEXT, sizeof context, &context, nullptr) != CL_SUCCESS ||
        clGetMemObjectInfo(memory, CL_MEM_TYPE, sizeof type, &type, nullptr) != CL_SUCCESS ||
        clGetMemObjectInfo(memory, CL_MEM_FLAGS, sizeof flags, &flags, nullptr) != CL_SUCCESS ||
        clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof bytes, &bytes, nullptr) != CL_SUCCESS)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".clMem: expected a cl_mem, got something OpenCL refuses");
    if (context != device.context())
        fail(LW_ERROR_INVALID_ARGUMENT, name,
             ".clMem: expected memory of the device's cl_context, got another's");
    if (type != CL_MEM_OBJECT_BUFFER)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".clMem: expected a buffer, got an object of OpenCL type ",
             type);
    if (flags & (written ? CL_MEM_READ_ONLY : CL_MEM_WRITE_ONLY))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".clMem: expected memory that kernels may ",
             written ? "write, got CL_MEM_READ_ONLY" : "read, got CL_MEM_WRITE_ONLY");
    if (checked.endByte > bytes)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".clMem: expected at least ", checked.endByte,
             " bytes for these offsets and strides, got ", bytes);
}

void checkHostMemory(Device& device, const CheckedImage& checked, const std::string& name) {
    const auto address = reinterpret_cast<std::uintptr_t>(checked.image.host);
    const std::uint32_t alignment = kFormats[checked.image.format].elementBytes;
    if (address % alignment != 0)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".host: expected an address that is a multiple of ",
             alignment, " bytes for this format, got ", checked.image.host);
    const std::uint64_t span = checked.endByte - checked.firstByte;
    if (checked.endByte > UINTPTR_MAX - address || span > device.maxAllocation())
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected offsets and strides that span at most ",
             device.maxAllocation(), " bytes, the device's largest buffer, got ", span);
    // First and last byte: enough for garbage in offsets and strides, and cheap enough for every frame.
    const char* memory = static_cast<const char*>(checked.image.host);
    for (const std::uint64_t byte : {checked.firstByte, checked.endByte - 1})
        if (!maybeMapped(memory + byte))
            fail(LW_ERROR_INVALID_ARGUMENT, name,
                 ": expected offsets and strides inside the memory at host, got byte ", byte,
                 " which this process does not have");
}

}  // namespace

#define LW_COLOUR_FLOATS LW_FORMAT_FLOAT3, LW_FORMAT_FLOAT4, LW_FORMAT_HALF4, LW_FORMAT_PLANAR_FLOAT3
const ImageRole kPositionRole{3, formatSet({LW_COLOUR_FLOATS})};
const ImageRole kDepthRole{1, formatSet({LW_FORMAT_FLOAT1})};
const ImageRole kNormalRole{3, formatSet({LW_COLOUR_FLOATS, LW_FORMAT_UNORM8X4, LW_FORMAT_OCT16X2}),
                            LW_ROLE_NORMAL};
const ImageRole kAlbedoRole{3,
                            formatSet({LW_COLOUR_FLOATS, LW_FORMAT_UNORM8X4, LW_FORMAT_UNORM8X4_SRGB})};
const ImageRole kRadianceRole{3, formatSet({LW_COLOUR_FLOATS})};
const ImageRole kScalarRole{1, formatSet({LW_FORMAT_FLOAT1})};
const ImageRole kMotionRole{2, formatSet({LW_FORMAT_FLOAT2, LW_FORMAT_PLANAR_FLOAT2})};
const ImageRole kMaskRole{1, formatSet({LW_FORMAT_FLOAT1, LW_FORMAT_UINT8})};
const ImageRole kOutputColourRole{3, formatSet({LW_COLOUR_FLOATS}), LW_ROLE_VALUE, true};
const ImageRole kOutputScalarRole{1, formatSet({LW_FORMAT_FLOAT1}), LW_ROLE_VALUE, true};
#undef LW_COLOUR_FLOATS

std::uint32_t largestPixelBytes(const ImageRole& role) {
    std::uint32_t most = 0;
    for (unsigned format = 0; format < kFormatCount; ++format)
        if (role.formats & (1u << format)) most = std::max(most, kFormats[format].pixelBytes * kFormats[format].planes);
    return most;
}

bool imageAbsent(const LWImage& image) {
    return rawEnum(image.format) == LW_FORMAT_NONE && !image.host && !image.clMem;
}

CheckedImage checkImage(Device& device, const LWImage& image, const ImageRole& role, std::uint32_t width,
                        std::uint32_t height, const std::string& name) {
    if (!image.host == !image.clMem)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected exactly one of host and clMem, got ",
             image.host ? "both" : "neither");
    checkFormat(image, role, name);
    if (image.width != width || image.height != height)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected ", width, " x ", height, " pixels, got ",
             image.width, " x ", image.height);

    CheckedImage checked{};
    checked.image = image;
    checked.pixels = resolveLayout(image, role, name);
    const LwPixels& pixels = checked.pixels;
    const FormatFacts& facts = kFormats[image.format];
    const std::int64_t lastRow = (std::int64_t(height) - 1) * pixels.byteRowStride;
    const std::int64_t first = pixels.byteOffset + std::min<std::int64_t>(lastRow, 0);
    if (first < 0)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".byteOffset: expected at least ", -lastRow,
             ", so that no row starts before the memory, got ", image.byteOffset);
    const std::int64_t lastPlane = std::int64_t(facts.planes - 1) * pixels.bytePlaneStride;
    const std::int64_t lastStart = pixels.byteOffset + std::max<std::int64_t>(lastRow, 0) + lastPlane;
    checked.pixelBytes = facts.pixelBytes;
    checked.planes = facts.planes;
    checked.firstByte = std::uint64_t(first);
    checked.endByte =
        std::uint64_t(lastStart + (std::int64_t(width) - 1) * pixels.bytePixelStride) + facts.pixelBytes;
    checked.paddedEndByte = std::uint64_t(lastStart) + paddedWidth(width) * sizeof(float);

    const bool planar = facts.planes > 1 || image.format == LW_FORMAT_FLOAT1;
    const auto start = reinterpret_cast<std::uintptr_t>(image.host) + std::uintptr_t(pixels.byteOffset);
    const std::int64_t rows = pixels.byteRowStride < 0 ? -pixels.byteRowStride : pixels.byteRowStride;
    checked.planesLayout = planar && pixels.bytePixelStride == sizeof(float) && start % 64 == 0 &&
                           rows % 64 == 0 && (facts.planes == 1 || pixels.bytePlaneStride % 64 == 0) &&
                           std::int64_t(checked.paddedEndByte) / 4 <= kLargestFloatIndex;
    if (image.clMem)
        checkMemoryObject(device, checked, role.written, name);
    else
        checkHostMemory(device, checked, name);
    return checked;
}

}  // namespace lightwell
