#include "inputs/image_access.h"

#include <algorithm>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "gbuffer_input/gbuffer_input";

// What the report says about an image that is not used as it stands.
const char* unpackedChoice(const LWImage& image) {
    switch (image.format) {
        case LW_FORMAT_FLOAT1:
            return "float1, copied: its rows are not on 64-byte borders";
        case LW_FORMAT_FLOAT2:
            return "float2, unpacked";
        case LW_FORMAT_FLOAT3:
            return "float3, unpacked";
        case LW_FORMAT_FLOAT4:
            return "float4, unpacked";
        case LW_FORMAT_HALF4:
            return "half4, unpacked";
        case LW_FORMAT_UNORM8X4:
            return "unorm8x4, unpacked";
        case LW_FORMAT_UNORM8X4_SRGB:
            return "unorm8x4 sRGB, unpacked";
        case LW_FORMAT_OCT16X2:
            return "octahedral, unpacked";
        case LW_FORMAT_UINT8:
            return "uint8, unpacked";
        default:
            return "planar, copied: its rows are not on 64-byte borders";
    }
}

// The host's memory from its first byte on; with the last row's padding when it serves as planes.
std::size_t spanBytes(const CheckedImage& checked) {
    return std::size_t((checked.planesLayout ? checked.paddedEndByte : checked.endByte) - checked.firstByte);
}

}  // namespace

std::size_t stagingBytes(const Device& device, const CheckedImage& checked) {
    return checked.image.host && !device.unifiedMemory() ? spanBytes(checked) : 0;
}

void reserveStaging(Buffer& staging, Device& device, const CheckedImage& checked, const View& view) {
    const std::size_t bytes = stagingBytes(device, checked);
    if (!bytes) return;
    const std::size_t width = checked.planesLayout ? paddedWidth(view.maxWidth) : view.maxWidth;
    const std::size_t largest = width * view.maxHeight * checked.pixelBytes * checked.planes;
    staging.reserve(device, std::max(bytes, largest), "an image's copy on the device");
}

Range rowGroup(const Device& device) {
    return {device.width() == 1 ? std::size_t(64) : std::size_t(16), 1};
}

Range rowGrid(const Device& device, std::uint32_t width, std::uint32_t height) {
    return {paddedWidth(width) / device.width(), height};
}

Planes subPlanes(const Planes& planes, std::uint32_t first, std::uint32_t count) {
    Planes part = planes;
    part.offset += std::int64_t(first) * planes.planeStride;
    part.count = count;
    return part;
}

DeviceImage openForReading(Executor& executor, const CheckedImage& checked, const ImageRole& role,
                           const char* uploadPass, Buffer& staging) {
    Device& device = executor.device();
    const LWImage& image = checked.image;
    DeviceImage result;
    result.pixels = checked.pixels;
    result.decode = role.decode;
    bool planes = checked.planesLayout;
    if (image.clMem) {
        result.memory = Buffer::retained(device, static_cast<cl_mem>(image.clMem));
        planes = planes && checked.paddedEndByte <= result.memory.bytes();
        result.choice = "device memory, used in place";
    } else {
        const std::size_t bytes = spanBytes(checked);
        const char* start = static_cast<const char*>(image.host) + checked.firstByte;
        if (device.unifiedMemory()) {
            result.memory = Buffer::overHost(device, const_cast<char*>(start), bytes, false);
            result.choice = "planar, used in place";
        } else {
            staging.reserve(device, bytes, "an image's copy on the device");
            result.memory = Buffer::retained(device, staging.get());
            executor.write(uploadPass, staging, 0, bytes, start);
            result.choice = "planar, uploaded";
        }
        result.pixels.byteOffset -= std::int64_t(checked.firstByte);
    }
    if (!planes) {
        result.choice = unpackedChoice(image);
        return result;
    }
    const LwPixels& pixels = result.pixels;
    result.planes.memory = result.memory.get();
    result.planes.offset = pixels.byteOffset / 4;
    result.planes.rowStride = pixels.byteRowStride / 4;
    result.planes.planeStride = pixels.bytePlaneStride / 4;
    result.planes.width = std::uint32_t(pixels.width);
    result.planes.height = std::uint32_t(pixels.height);
    result.planes.count = std::uint32_t(pixels.channels);
    return result;
}

void unpack(Executor& executor, const char* pass, const DeviceImage& image, const Planes& to) {
    Device& device = executor.device();
    Kernel& kernel = device.programs().kernel(kProgram, "gbuffer_input_unpack");
    executor.run(pass, kernel, rowGrid(device, to.width, to.height), rowGroup(device), image.memory,
                 image.pixels, cl_int(image.decode), to);
}

void unproject(Executor& executor, const char* pass, const DeviceImage& depth, const DeviceImage& normal,
               const LwUnprojection& unprojection, const Planes& position, const Planes& normals) {
    Device& device = executor.device();
    Kernel& kernel = device.programs().kernel(kProgram, "gbuffer_input_unproject");
    executor.run(pass, kernel, rowGrid(device, position.width, position.height), rowGroup(device),
                 depth.memory, depth.pixels, normal.memory, normal.pixels, unprojection, position,
                 normals);
}

}  // namespace lightwell
