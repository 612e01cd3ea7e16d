// A host's image in any format and layout, with its own plain encoding and decoding, and a pattern in
// every byte that belongs to no pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell::test {

// Float16, round to nearest even, by its definition.
inline std::uint16_t toHalf(double value) {
    const std::uint16_t sign = std::signbit(value) ? 0x8000 : 0;
    const double magnitude = std::fabs(value);
    if (std::isnan(value)) return 0x7e00;
    if (magnitude >= 65520.0) return std::uint16_t(sign | 0x7c00);
    if (magnitude == 0.0) return sign;
    int exponent = 0;
    std::frexp(magnitude, &exponent);               // magnitude = f * 2^exponent, f in [1/2, 1)
    const int unit = std::max(exponent - 11, -24);  // of the last place
    const double steps = std::nearbyint(std::ldexp(magnitude, -unit));
    // Subnormals and normals are numbered without a gap.
    const auto code =
        unit == -24 ? std::uint32_t(steps) : std::uint32_t((unit + 24) * 1024 + int(steps));
    return std::uint16_t(sign | code);
}

inline double fromHalf(std::uint16_t half) {
    const int exponent = (half >> 10) & 31, fraction = half & 1023;
    const double sign = half & 0x8000 ? -1.0 : 1.0;
    if (exponent == 31) return fraction ? std::nan("") : sign * HUGE_VAL;
    return sign * (exponent ? std::ldexp(1024 + fraction, exponent - 25) : std::ldexp(fraction, -24));
}

// What a C host may have left in an enum.
template <class Enum>
void setEnum(Enum& field, std::uint32_t value) {
    static_assert(sizeof field == sizeof value, "an LW enum has 32 bits");
    std::memcpy(&field, &value, sizeof value);
}

struct HostLayout {
    std::uint32_t rowGap = 0;    // bytes between rows
    std::uint32_t pixelGap = 0;  // bytes between pixels
    std::uint32_t offset = 0;    // bytes before the first pixel
    bool bottomUp = false;
    bool aligned = false;  // rows of whole groups of 16 pixels on 64-byte borders
};

class HostImage {
public:
    static constexpr unsigned char kPattern = 0xCD;

    HostImage() = default;
    HostImage(LWFormat format, std::uint32_t width, std::uint32_t height, const HostLayout& layout = {})
        : format_(format), width_(width), height_(height) {
        const bool planar = format == LW_FORMAT_PLANAR_FLOAT2 || format == LW_FORMAT_PLANAR_FLOAT3;
        planes_ = format == LW_FORMAT_PLANAR_FLOAT3 ? 3 : format == LW_FORMAT_PLANAR_FLOAT2 ? 2 : 1;
        static constexpr std::int64_t kBytes[] = {0, 4, 8, 12, 16, 8, 4, 4, 4, 4, 4, 1};
        pixelBytes_ = kBytes[format];
        pixelStride_ = pixelBytes_ + layout.pixelGap;
        rowStride_ = width * pixelStride_ + layout.rowGap;
        if (layout.aligned) rowStride_ = (rowStride_ + 63) / 64 * 64;
        planeStride_ = planar ? rowStride_ * height : 0;
        size_ = std::size_t(layout.offset + rowStride_ * height * planes_);
        storage_.assign(size_ + 128, kPattern);
        const auto address = reinterpret_cast<std::uintptr_t>(storage_.data());
        start_ = std::size_t((address + 63) / 64 * 64 - address);
        offset_ = layout.offset;
        if (layout.bottomUp) {
            offset_ += rowStride_ * (height - 1);
            rowStride_ = -rowStride_;
        }
    }
    HostImage(const HostImage&) = delete;
    HostImage& operator=(const HostImage&) = delete;
    HostImage(HostImage&&) = default;
    HostImage& operator=(HostImage&&) = default;

    LWImage image() {
        LWImage result{};
        result.host = storage_.data() + start_;
        result.format = format_;
        result.width = width_;
        result.height = height_;
        result.byteOffset = std::uint64_t(offset_);
        result.bytePixelStride = pixelStride_;
        result.byteRowStride = rowStride_;
        result.bytePlaneStride = planeStride_;
        return result;
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

    // Stores a pixel as a host would; `normal`: unorm8 takes n/2 + 1/2.
    void set(std::uint32_t x, std::uint32_t y, double a, double b = 0.0, double c = 0.0,
             bool normal = false) {
        const double v[4] = {a, b, c, 0.25};
        switch (format_) {
            case LW_FORMAT_HALF4:
                for (int k = 0; k < 4; ++k) put(x, y, 0, 2 * k, toHalf(v[k]));
                break;
            case LW_FORMAT_UNORM8X4:
            case LW_FORMAT_UNORM8X4_SRGB:
                for (int k = 0; k < 4; ++k) {
                    const double unit = normal ? v[k] / 2 + 0.5 : v[k];
                    put(x, y, 0, k,
                        std::uint8_t(std::lround(std::fmin(std::fmax(unit, 0.0), 1.0) * 255)));
                }
                break;
            case LW_FORMAT_OCT16X2: {
                const double sum = std::fabs(a) + std::fabs(b) + std::fabs(c);
                double u = a / sum, w = b / sum;
                if (c < 0) {
                    const double folded = (1 - std::fabs(w)) * (u < 0 ? -1 : 1);
                    w = (1 - std::fabs(u)) * (w < 0 ? -1 : 1);
                    u = folded;
                }
                put(x, y, 0, 0, sum > 0 ? std::int16_t(std::lround(u * 32767)) : std::int16_t(-32768));
                put(x, y, 0, 2, sum > 0 ? std::int16_t(std::lround(w * 32767)) : std::int16_t(-32768));
                break;
            }
            case LW_FORMAT_UINT8:
                put(x, y, 0, 0, std::uint8_t(a));
                break;
            default:
                if (planes_ > 1)
                    for (int k = 0; k < planes_; ++k) put(x, y, k, 0, float(v[k]));
                else
                    for (int k = 0; k < int(pixelBytes_) / 4; ++k) put(x, y, 0, 4 * k, float(v[k]));
        }
    }
    template <class T>
    T get(std::uint32_t x, std::uint32_t y, int plane, int byte) const {
        T value;
        std::memcpy(&value, storage_.data() + at(x, y, plane, byte), sizeof value);
        return value;
    }
    // Channel c of a float or half format.
    double value(std::uint32_t x, std::uint32_t y, int c) const {
        if (format_ == LW_FORMAT_HALF4) return fromHalf(get<std::uint16_t>(x, y, 0, 2 * c));
        return planes_ > 1 ? double(get<float>(x, y, c, 0)) : double(get<float>(x, y, 0, 4 * c));
    }
    // Bytes outside all pixels that no longer hold the pattern. `padding`: pixels past the end of a row
    // up to the next multiple of 16 may have been written.
    std::size_t damagedBytes(bool padding = false) const {
        std::vector<bool> owned(storage_.size(), false);
        const std::uint32_t width = padding ? (width_ + 15) / 16 * 16 : width_;
        for (int plane = 0; plane < planes_; ++plane)
            for (std::uint32_t y = 0; y < height_; ++y)
                for (std::uint32_t x = 0; x < width; ++x)
                    for (int b = 0; b < pixelBytes_; ++b) owned[at(x, y, plane, b)] = true;
        std::size_t damaged = 0;
        for (std::size_t i = 0; i < storage_.size(); ++i)
            if (!owned[i] && storage_[i] != kPattern) ++damaged;
        return damaged;
    }

private:
    std::size_t at(std::uint32_t x, std::uint32_t y, int plane, int byte) const {
        return start_ +
               std::size_t(offset_ + y * rowStride_ + x * pixelStride_ + plane * planeStride_ + byte);
    }
    template <class T>
    void put(std::uint32_t x, std::uint32_t y, int plane, int byte, T value) {
        std::memcpy(storage_.data() + at(x, y, plane, byte), &value, sizeof value);
    }

    LWFormat format_ = LW_FORMAT_NONE;
    std::uint32_t width_ = 0, height_ = 0;
    int planes_ = 0;
    std::int64_t pixelBytes_ = 0, pixelStride_ = 0, rowStride_ = 0, planeStride_ = 0, offset_ = 0;
    std::size_t size_ = 0, start_ = 0;
    std::vector<unsigned char> storage_;
};

}  // namespace lightwell::test
