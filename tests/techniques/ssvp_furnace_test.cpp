// Bounces of technique ssvp in an integrating sphere, where every bounce is known: any part of a sphere lights all of it
// alike, so that of flux Phi reflected in all the irradiance is Phi / (4 pi R^2), and each further bounce carries the
// albedo's share of the one before.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lit_room.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kRadius = 2.0, kAlbedo = 0.6, kFlux = 30.0;
constexpr std::uint32_t kWidth = 64, kHeight = 48;
// The triangles' chords lie inside the sphere, nowhere deeper than this: VPLs stand before them.
constexpr double kInside = 0.9985;

Vec onSphere(double u, double v) {  // evenly by area, of radius 1
    const double z = 1.0 - 2.0 * u, r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(2.0 * M_PI * v), z, r * std::sin(2.0 * M_PI * v)};
}

struct Sphere {
    PlanarPixels position{kWidth, kHeight, 3}, normal{kWidth, kHeight, 3};
    LWGBuffer gbuffer{};
    std::vector<float> vertices, albedo;
    std::vector<LWVpl> vpls;
    LWGeometry geometry{};

    Sphere() {
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) {
                const Vec d = onSphere((y + 0.5) / kHeight, (x + 0.5) / kWidth);
                position.set(x, y, d * kRadius);
                normal.set(x, y, d * -1.0);
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        // A cap of the sphere, an eighth of its area, lit evenly; its VPLs on a spiral.
        constexpr int kVpls = 256;
        for (int k = 0; k < kVpls; ++k) {
            const Vec d = onSphere((k + 0.5) / kVpls / 8.0, k * 0.618033988749895);
            LWVpl vpl{};
            const double p[3] = {d.x, d.y, d.z};
            for (int a = 0; a < 3; ++a) {
                vpl.position[a] = float(kInside * kRadius * p[a]);
                vpl.normal[a] = float(-p[a]);
                vpl.flux[a] = float(kFlux / kVpls);
            }
            vpl.area = float(4.0 * M_PI * kRadius * kRadius / 8.0 / kVpls);
            vpls.push_back(vpl);
        }
        addTriangles(48, 96);
    }

    void addTriangles(int rows, int columns) {
        const auto corner = [&](int i, int j) {
            const double theta = M_PI * i / rows, phi = 2.0 * M_PI * j / columns;
            return Vec{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)} * kRadius;
        };
        const auto add = [&](Vec a, Vec b, Vec c) {
            for (const Vec& v : {a, b, c})
                for (const double x : {v.x, v.y, v.z}) vertices.push_back(float(x));
            for (int channel = 0; channel < 3; ++channel) albedo.push_back(float(kAlbedo));
        };
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                if (i > 0) add(corner(i, j), corner(i, j + 1), corner(i + 1, j));
                if (i + 1 < rows) add(corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j));
            }
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        geometry.triangleAlbedo = albedo.data();
        geometry.version = 1;
    }

    double meanIrradiance(LWDevice device, const LWSsvpDesc& desc) {
        TestTechnique technique(device, desc);
        TestView view(device, kWidth, kHeight);
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.vpls = vpls.data();
        frame.vplCount = std::uint32_t(vpls.size());
        frame.geometry = &geometry;
        technique.update(frame);
        double sum = 0.0;
        const std::vector<float> light = technique.render(view, gbuffer);
        for (const float e : light) sum += double(e);
        return sum / double(light.size());
    }
};

LWSsvpDesc descOf(std::uint32_t clusters, std::uint32_t bounces) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.clusters = clusters;
    desc.bounces = bounces;
    return desc;
}

}  // namespace

TEST_CASE("each bounce in a sphere carries the albedo's share of the one before", "[ssvp]") {
    TestDevice device(GENERATE(1u, 16u));
    Sphere sphere;
    const auto clusters = GENERATE(1u, 8u, 32u);
    const auto directions = GENERATE(LW_DIRECTIONS_COSINE, LW_DIRECTIONS_DISC);
    double last = 0.0, lastAdded = kFlux / (4.0 * M_PI * kRadius * kRadius) / kAlbedo;
    for (std::uint32_t bounces = 1; bounces <= 4; ++bounces) {
        LWSsvpDesc desc = descOf(clusters, bounces);
        desc.visibility = LW_VISIBILITY_NONE;
        desc.directions = directions;
        desc.secondVpls = 256 / clusters;
        const double light = sphere.meanIrradiance(device, desc), added = light - last;
        CAPTURE(clusters, int(directions), bounces, added / (lastAdded * kAlbedo));
        CHECK(added == Approx(lastAdded * kAlbedo).epsilon(0.02));
        last = light;
        lastAdded = added;
    }
}

TEST_CASE("in a sphere nothing is shadowed, but for what lies beyond a cluster's rim", "[ssvp]") {
    TestDevice device(16);
    Sphere sphere;
    const double first = kFlux / (4.0 * M_PI * kRadius * kRadius);
    for (const std::uint32_t clusters : {1u, 8u, 32u, 0u})
        for (const std::uint32_t shadowed : {1u, 2u, 4u}) {
            const std::uint32_t bounces = std::max(shadowed, 2u);
            LWSsvpDesc desc = descOf(clusters, bounces);
            desc.shadowedBounces = shadowed;
            desc.secondVpls = clusters ? 256 / clusters : 4;
            const double light = sphere.meanIrradiance(device, desc), whole = first * (1.0 - std::pow(kAlbedo, bounces)) / (1.0 - kAlbedo);
            CAPTURE(clusters, shadowed, light / whole);
            CHECK(light <= 1.02 * whole);
            CHECK(light >= 0.9 * whole);
        }
}
