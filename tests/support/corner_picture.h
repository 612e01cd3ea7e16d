// Pictures for tests of techniques that see the screen alone: quads through a camera's pixels, a lit floor that meets a dark
// wall with its closed form, and one frame of technique screen_space through the C API.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "reference/pyramid_twin.h"
#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

namespace lightwell::test {

using reference::PinholeCamera;
using reference::Vec;

inline constexpr double kPi = 3.14159265358979323846;

inline LWScreenSpaceDesc descOf(LWStart start, std::uint32_t levels, std::uint32_t samples, float radius = 20.0f) {
    LWScreenSpaceDesc desc;
    lwDefaultScreenSpace(&desc);
    desc.start = start;
    desc.levels = levels;
    desc.samples = samples;
    desc.radius = radius;
    return desc;
}

// A picture: the nearest of some quads through each pixel.
struct Quad {
    Vec corner, u, v, normal;  // corner + a u + b v, a and b in [0, 1]; u and v perpendicular
    Vec radiance;
};
struct Picture {
    PlanarPixels position, normal, radiance, mask;
    LWGBuffer gbuffer{};
    PinholeCamera camera;

    Picture(std::uint32_t w, std::uint32_t h, double tangent, Vec eye, const std::vector<Quad>& quads, double scale = 1.0)
        : position(w, h, 3), normal(w, h, 3), radiance(w, h, 3), mask(w, h, 1), camera{eye, tangent, w, h} {
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const Vec d = camera.ray(x + 0.5, y + 0.5);
                double nearest = 1e30;
                for (const Quad& q : quads) {
                    const double along = dot(d, q.normal);
                    if (along >= 0.0) continue;
                    const double t = dot(q.corner - eye, q.normal) / along;
                    const Vec p = eye + d * t, at = p - q.corner;
                    const double a = dot(at, q.u) / dot(q.u, q.u), b = dot(at, q.v) / dot(q.v, q.v);
                    if (t <= 0.0 || t >= nearest || a < 0 || a > 1 || b < 0 || b > 1) continue;
                    nearest = t;
                    position.set(x, y, p * scale);
                    normal.set(x, y, q.normal);
                    radiance.set(x, y, q.radiance);
                }
            }
        camera.eye = eye * scale;
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        gbuffer.directRadiance = radiance.image();
        gbuffer.camera = camera.matrices();
    }
    Picture(const Picture&) = delete;
};

struct Result {
    std::vector<float> irradiance, validity;
    double e(std::size_t pixel) const { return double(irradiance[pixel]); }
};

inline Result render(TestTechnique& technique, const TestView& view, const LWGBuffer& gbuffer, LWDevice device,
              const std::vector<LWSourceView>& sources = {}, bool updates = true) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.sourceViewCount = std::uint32_t(sources.size());
    frame.sourceViews = sources.data();
    if (updates) technique.update(frame);
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    output.validity = validity.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {irradiance.packed(), validity.packed()};
}

// One frame on a fresh technique.
inline Result render(LWDevice device, const LWScreenSpaceDesc& desc, const Picture& picture, const std::vector<LWSourceView>& sources = {}) {
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, picture.camera.width, picture.camera.height);
    return render(technique, view, picture.gbuffer, device, sources);
}

// A floor of radiance 1 that meets a dark wall, both wholly on the screen: 2 wide, 1 deep, 1 high.
const Vec kFloor[4] = {{-1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 1}};
inline std::vector<Quad> litFloor(double light = 1.0) {
    return {{{-1, 0, 0}, {2, 0, 0}, {0, 0, 1}, {0, 1, 0}, {light, light, light}}, {{-1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}};
}
// Looks down at the corner: floor and wall are seen at like angles, and the edge between them lies at 4/5 of the picture's
// height, between two pixels wherever the height is a multiple of five. (Anywhere else the pixels do not hold what the polygon
// formula has: with the edge at 0.787 the light of all pixels, summed in double precision, is 4.8 % short at 90 rows and
// 3.9 % at 180, as the row that the edge cuts shows one of the two surfaces only. Here it is 0.7 and 0.2 % short.)
const Vec kEye{0, 0.702, 2.6};
struct CornerPicture : Picture {
    CornerPicture(std::uint32_t w, std::uint32_t h, double light = 1.0, double scale = 1.0)
        : Picture(w, h, 0.45, kEye, litFloor(light), scale) {}
};

// Against Lambert's polygon formula, over the wall's pixels: bias of the mean, and mean error, both relative.
struct Error {
    double bias, mean;
};
inline Error wallError(Picture& picture, const Result& result) {
    double got = 0.0, truth = 0.0, error = 0.0;
    for (std::uint32_t y = 0; y < picture.camera.height; ++y)
        for (std::uint32_t x = 0; x < picture.camera.width; ++x) {
            if (picture.normal.get(x, y).z < 0.5) continue;
            const double expected = polygonIrradiance({kFloor[0], kFloor[1], kFloor[2], kFloor[3]}, picture.position.get(x, y),
                                                      picture.normal.get(x, y), kPi);
            const double e = result.e(std::size_t(y) * picture.camera.width + x);
            got += e;
            truth += expected;
            error += std::abs(e - expected);
        }
    return {got / truth - 1.0, error / truth};
}

}  // namespace lightwell::test
