// A scene in a few lines for tests of techniques through the C API, with closed forms: a floor patch lit
// from above (its RSM), and a wall and a ceiling that receive its light. Planar images in rows of a
// multiple of 16, as the API takes them in place.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "lightwell/lightwell.h"
#include "reference/surfaces.h"

namespace lightwell::test {

// 64-byte aligned planes of width x height pixels, rows padded to 16.
class PlanarPixels {
public:
    PlanarPixels(std::uint32_t width, std::uint32_t height, std::uint32_t planes)
        : width_(width), height_(height), planes_(planes), stride_((width + 15u) & ~15u),
          memory_(static_cast<float*>(std::aligned_alloc(64, bytes())), std::free) {
        for (std::size_t i = 0; i < bytes() / 4; ++i) memory_.get()[i] = 0.0f;
    }
    LWImage image() const {
        LWImage image{};
        image.host = memory_.get();
        image.format = planes_ == 1 ? LW_FORMAT_FLOAT1 : LW_FORMAT_PLANAR_FLOAT3;
        image.width = width_;
        image.height = height_;
        image.byteRowStride = std::int64_t(stride_) * 4;
        image.bytePlaneStride = image.byteRowStride * height_;
        return image;
    }
    float& at(std::uint32_t x, std::uint32_t y, std::uint32_t plane) {
        return memory_.get()[(std::size_t(plane) * height_ + y) * stride_ + x];
    }
    void set(std::uint32_t x, std::uint32_t y, reference::Vec v) {
        at(x, y, 0) = float(v.x);
        at(x, y, 1) = float(v.y);
        at(x, y, 2) = float(v.z);
    }
    reference::Vec get(std::uint32_t x, std::uint32_t y) const {
        auto plane = [&](std::uint32_t p) {
            return double(memory_.get()[(std::size_t(p) * height_ + y) * stride_ + x]);
        };
        return {plane(0), plane(1), plane(2)};
    }
    std::vector<float> packed() {
        std::vector<float> values;
        for (std::uint32_t p = 0; p < planes_; ++p)
            for (std::uint32_t y = 0; y < height_; ++y)
                for (std::uint32_t x = 0; x < width_; ++x) values.push_back(at(x, y, p));
        return values;
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

private:
    std::size_t bytes() const { return std::size_t(planes_) * height_ * stride_ * 4; }
    std::uint32_t width_, height_, planes_, stride_;
    std::unique_ptr<float, void (*)(void*)> memory_;
};

// The floor z in [0,1], x in [-1/2,1/2] at y = 0, lit straight from above. `profile(x, z)`: the reflected
// exitance (W/m^2), grey. Lengths times `scale`.
struct LitFloor {
    PlanarPixels position, normal, flux;
    LWRsm rsm{};
    LWLight light{};

    LitFloor(std::uint32_t size, std::function<double(double, double)> profile, double scale = 1.0)
        : position(size, size, 3), normal(size, size, 3), flux(size, size, 3) {
        const double texel = scale * scale / (double(size) * size);
        for (std::uint32_t j = 0; j < size; ++j)
            for (std::uint32_t i = 0; i < size; ++i) {
                const double x = (i + 0.5) / size - 0.5, z = (j + 0.5) / size, power = profile(x, z) * texel;
                position.set(i, j, {x * scale, 0.0, z * scale});
                normal.set(i, j, {0, 1, 0});
                flux.set(i, j, {power, power, power});
            }
        rsm.structSize = sizeof rsm;
        rsm.position = position.image();
        rsm.normal = normal.image();
        rsm.flux = flux.image();
        // Looks down -y from y = 1, up = -z; orthographic, one unit wide and high.
        const double s = scale;
        const double view[16] = {1, 0, 0, 0, 0, 0, -1, 0.5 * s, 0, 1, 0, -s, 0, 0, 0, 1};
        const double projection[16] = {2 / s, 0, 0, 0, 0, 2 / s, 0, 0, 0, 0, -0.5 / s, 0, 0, 0, 0, 1};
        for (int k = 0; k < 16; ++k) {
            rsm.camera.view[k] = float(view[k]);
            rsm.camera.projection[k] = float(projection[k]);
        }
        light.structSize = sizeof light;
        light.kind = LW_LIGHT_DIRECTIONAL;
        light.direction[1] = -1.0f;
        light.rsmCount = 1;
        light.rsms = &rsm;
    }
    LitFloor(const LitFloor&) = delete;
};

// A view whose upper half is the wall at z = 0 above the floor (y from 1/10 to 1.1) and whose lower half
// is the ceiling at y = 1; its first column is background.
struct WallAndCeiling {
    PlanarPixels position, normal;
    LWGBuffer gbuffer{};

    WallAndCeiling(std::uint32_t width, std::uint32_t height, double scale = 1.0)
        : position(width, height, 3), normal(width, height, 3) {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 1; x < width; ++x) {
                const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height;
                position.set(x, y, v < 0.5 ? reference::Vec{u * scale, (1.1 - 2.0 * v) * scale, 0.0}
                                           : reference::Vec{u * scale, scale, (2.0 * v - 1.0) * scale});
                normal.set(x, y, v < 0.5 ? reference::Vec{0, 0, 1} : reference::Vec{0, -1, 0});
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
    }
    WallAndCeiling(const WallAndCeiling&) = delete;
};

// Irradiance of a uniform Lambertian polygon of exitance `exitance` at a point (Lambert): the polygon must
// lie above the receiver's horizon.
inline double polygonIrradiance(const std::vector<reference::Vec>& corners, reference::Vec point, reference::Vec normal,
                                double exitance) {
    auto cross = [](reference::Vec a, reference::Vec b) {
        return reference::Vec{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto a = reference::unit(corners[i] - point), b = reference::unit(corners[(i + 1) % corners.size()] - point);
        const auto c = cross(a, b);
        const double length = std::sqrt(reference::dot(c, c));
        if (length > 0.0) sum += std::acos(std::min(1.0, std::max(-1.0, reference::dot(a, b)))) * reference::dot(normal, c) / length;
    }
    return exitance * std::abs(sum) / (2.0 * 3.14159265358979323846);
}

}  // namespace lightwell::test
