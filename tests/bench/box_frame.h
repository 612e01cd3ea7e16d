// A frame for benchmarks: the inside of a box seen by a camera, and a spot light's RSM of it, ray-cast
// in closed form. No pass's cost depends on the picture; edges and lit corners are there for the
// filters.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lightwell/lightwell.h"

namespace bench {

using Vec3 = std::array<float, 3>;

constexpr Vec3 kBoxMin{-3.0f, 0.0f, -6.0f}, kBoxMax{3.0f, 3.0f, 6.0f};
constexpr std::size_t kAlignment = 64;  // of rows used in place

// Three float planes, rows padded to 16 pixels, aligned: what Lightwell uses without a copy.
class PlanarImage {
public:
    PlanarImage(std::uint32_t width, std::uint32_t height)
        : width_(width),
          height_(height),
          rowFloats_((width + 15) / 16 * 16),
          memory_(3 * rowFloats_ * height + kAlignment / 4) {
        const auto address = reinterpret_cast<std::uintptr_t>(memory_.data());
        first_ = memory_.data() + (kAlignment - address % kAlignment) % kAlignment / 4;
    }
    PlanarImage(const PlanarImage&) = delete;
    PlanarImage& operator=(const PlanarImage&) = delete;
    void set(std::uint32_t x, std::uint32_t y, const Vec3& value) {
        for (std::size_t c = 0; c < 3; ++c) first_[(c * height_ + y) * rowFloats_ + x] = value[c];
    }
    LWImage view() const {
        LWImage image = {};
        image.host = first_;
        image.format = LW_FORMAT_PLANAR_FLOAT3;
        image.width = width_;
        image.height = height_;
        image.byteRowStride = std::int64_t(rowFloats_ * sizeof(float));
        return image;
    }

private:
    std::uint32_t width_, height_;
    std::size_t rowFloats_;
    std::vector<float> memory_;
    float* first_ = nullptr;
};

// A camera at `eye` looking down -z with half-angle tangents tanX and tanY.
struct Eye {
    Vec3 position;
    float tanX, tanY;
    LWCamera camera() const {
        LWCamera result = {};
        const float view[16] = {1, 0, 0, -position[0], 0, 1, 0, -position[1],
                                0, 0, 1, -position[2], 0, 0, 0, 1};
        // Near plane 0.1, far plane at infinity, clip z in [0,1].
        const float projection[16] = {1 / tanX, 0, 0,  0,     0, 1 / tanY, 0,  0,
                                      0,        0, -1, -0.1f, 0, 0,        -1, 0};
        for (std::size_t i = 0; i < 16; ++i) {
            result.view[i] = view[i];
            result.projection[i] = projection[i];
        }
        return result;
    }
};

// Positions and inward normals of the box as `eye` sees it.
inline void castBox(const Eye& eye, std::uint32_t width, std::uint32_t height, PlanarImage& position,
                    PlanarImage& normal) {
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const Vec3 ray{eye.tanX * (2 * (float(x) + 0.5f) / float(width) - 1),
                           eye.tanY * (1 - 2 * (float(y) + 0.5f) / float(height)), -1.0f};
            float nearest = 1e30f;
            Vec3 facing{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (ray[axis] == 0.0f) continue;
                const float wall = ray[axis] > 0 ? kBoxMax[axis] : kBoxMin[axis];
                const float distance = (wall - eye.position[axis]) / ray[axis];
                if (distance >= nearest) continue;
                nearest = distance;
                facing = {};
                facing[axis] = ray[axis] > 0 ? -1.0f : 1.0f;
            }
            Vec3 point;
            for (std::size_t c = 0; c < 3; ++c) point[c] = eye.position[c] + nearest * ray[c];
            position.set(x, y, point);
            normal.set(x, y, facing);
        }
}

// One view and one spot light with its RSM, all in memory that Lightwell uses in place.
class BoxFrame {
public:
    BoxFrame(std::uint32_t width, std::uint32_t height, std::uint32_t rsmSize)
        : position_(width, height),
          normal_(width, height),
          rsmPosition_(rsmSize, rsmSize),
          rsmNormal_(rsmSize, rsmSize),
          rsmFlux_(rsmSize, rsmSize),
          irradiance_(width, height) {
        const Eye viewer{{0.5f, 1.6f, 5.0f}, 0.9f, 0.9f * float(height) / float(width)};
        const Eye spot{{-1.5f, 1.5f, 3.0f}, 0.6f, 0.6f};
        castBox(viewer, width, height, position_, normal_);
        castBox(spot, rsmSize, rsmSize, rsmPosition_, rsmNormal_);
        // An even 1 W: this frame is about cost, not about the light's profile.
        const float flux = 1.0f / float(rsmSize * rsmSize);
        for (std::uint32_t y = 0; y < rsmSize; ++y)
            for (std::uint32_t x = 0; x < rsmSize; ++x) rsmFlux_.set(x, y, {flux, flux, flux});

        LW_INIT(rsm);
        rsm.position = rsmPosition_.view();
        rsm.normal = rsmNormal_.view();
        rsm.flux = rsmFlux_.view();
        rsm.camera = spot.camera();
        LW_INIT(light);
        light.kind = LW_LIGHT_SPOT;
        light.direction[2] = -1.0f;
        light.outerConeAngle = std::atan(0.6f);
        for (std::size_t c = 0; c < 3; ++c) {
            light.position[c] = spot.position[c];
            light.radiantIntensity[c] = 1.0f;
        }
        light.rsmCount = 1;
        light.rsms = &rsm;
        LW_INIT(frame);
        frame.lightCount = 1;
        frame.lights = &light;
        LW_INIT(gbuffer);
        gbuffer.position = position_.view();
        gbuffer.normal = normal_.view();
        gbuffer.camera = gbuffer.previousCamera = viewer.camera();
        LW_INIT(output);
        output.irradiance = irradiance_.view();
    }
    BoxFrame(const BoxFrame&) = delete;
    BoxFrame& operator=(const BoxFrame&) = delete;

    LWRsm rsm;
    LWLight light;
    LWFrame frame;
    LWGBuffer gbuffer;
    LWOutput output;

private:
    PlanarImage position_, normal_, rsmPosition_, rsmNormal_, rsmFlux_, irradiance_;
};

}  // namespace bench
