// lwRenderPoints through the C API: the same light as lwRender's to the bit, whatever the list; closed forms of light in two bands.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>

#include "support/lpv_room.h"
#include "support/points_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 61, kHeight = 32;
constexpr double kPi = 3.14159265358979323846;

double tilesProfile(double x, double z) { return std::fmod(std::floor(x * 9.1) + std::floor(z * 9.1), 2.0) != 0.0 ? 0.2 : 1.0; }

// A technique with its own parameters, as every test below runs over all that have light at points.
struct Maker {
    const char* name;
    std::function<std::unique_ptr<TestTechnique>(LWDevice)> make;
};

Maker rsmOf(std::uint32_t vpls, std::uint32_t interleave) {
    return {"rsm", [=](LWDevice device) {
                LWRsmDesc desc;
                lwDefaultRsm(&desc);
                desc.vpls = vpls;
                desc.interleave = interleave;
                return std::make_unique<TestTechnique>(device, desc);
            }};
}
Maker ssvpOf(LWVisibility visibility, std::uint32_t bounces, std::uint32_t shadowed = 1, std::uint32_t interleave = 1) {
    return {"ssvp", [=](LWDevice device) {
                LWSsvpDesc desc;
                lwDefaultSsvp(&desc);
                desc.vpls = 64;
                desc.clusters = 8;
                desc.secondVpls = 16;
                desc.mapSize = 64;
                desc.visibility = visibility;
                desc.bounces = bounces;
                desc.shadowedBounces = shadowed;
                desc.interleave = interleave;
                return std::make_unique<TestTechnique>(device, desc);
            }};
}
Maker lpvOf(LWLpvTransport transport, bool damped = false, std::uint32_t frames = 1, std::uint32_t cascades = 1) {
    return {"lpv", [=](LWDevice device) {
                LWLpvDesc desc;
                lwDefaultLpv(&desc);
                desc.size = 16;
                desc.transport = transport;
                desc.damping = damped ? 1 : 0;
                desc.frames = frames;
                desc.cascades = cascades;
                desc.geometryVolume = LW_GEOMETRY_VOLUME_AUTO;
                return std::make_unique<TestTechnique>(device, "lpv", &desc);
            }};
}
std::vector<Maker> makers() {
    return {rsmOf(256, 1), rsmOf(0, 1), ssvpOf(LW_VISIBILITY_HARD, 2), ssvpOf(LW_VISIBILITY_SOFT, 3, 2), ssvpOf(LW_VISIBILITY_NONE, 1),
            lpvOf(LW_LPV_TRANSPORT_PROPAGATE), lpvOf(LW_LPV_TRANSPORT_PROPAGATE, true), lpvOf(LW_LPV_TRANSPORT_SWEEP),
            lpvOf(LW_LPV_TRANSPORT_SWEEP, false, 4), lpvOf(LW_LPV_TRANSPORT_COARSE_TO_FINE),
            lpvOf(LW_LPV_TRANSPORT_PROPAGATE, false, 1, 3), lpvOf(LW_LPV_TRANSPORT_SWEEP, false, 1, 3)};
}

// The lit room with its triangles, as one frame.
struct Room {
    LitFloor floor{64, tilesProfile};
    WallAndCeiling scene{kWidth, kHeight};
    RoomTriangles triangles{1.0};
    std::vector<LWLight> lights{floor.light};
    LWFrame frame{};
    Room() {
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = 1;
        frame.geometry = &triangles.geometry;
    }
};

// Packed planes of a view as r, g, b of each pixel.
std::vector<float> interleavedPixels(const std::vector<float>& planes) {
    const std::size_t n = planes.size() / 3;
    std::vector<float> values(planes.size());
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < 3; ++c) values[3 * i + c] = planes[c * n + i];
    return values;
}

std::uint32_t backgrounds(const PointList& list) {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < list.count(); ++i)
        count += list.normals[3 * i] == 0.0f && list.normals[3 * i + 1] == 0.0f && list.normals[3 * i + 2] == 0.0f ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE("light at points is the view's at its pixels, to the bit, and leaves the view as it is", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    for (const Maker& maker : makers()) {
        CAPTURE(maker.name);
        const auto technique = maker.make(device);
        TestView view(device, kWidth, kHeight);
        technique->update(room.frame);
        const std::vector<float> picture = technique->render(view, room.scene.gbuffer);
        const PointLights points = renderPoints(device, *technique, list);
        CHECK(points.irradiance == interleavedPixels(picture));
        CHECK(technique->render(view, room.scene.gbuffer) == picture);
        CHECK(technique->count("points") == list.count());
        CHECK(technique->count("rejected_points") == backgrounds(list));
        // Each output alone.
        CHECK(renderPoints(device, *technique, list, kPointIrradiance).irradiance == points.irradiance);
        CHECK(renderPoints(device, *technique, list, kPointHarmonics).harmonics == points.harmonics);
        CHECK(renderPoints(device, *technique, list, kPointValidity).validity == points.validity);
        CHECK(technique->count("points") == 4 * list.count());
        double lit = 0.0;
        for (const float e : points.irradiance) lit += double(e);
        CHECK(lit > 0.0);
    }
}

TEST_CASE("a point's light does not depend on the list around it", "[points]") {
    TestDevice device(16);
    const Room room;
    const PointList all = PointList::ofScene(room.scene);
    for (const Maker& maker : makers()) {
        CAPTURE(maker.name);
        const auto technique = maker.make(device);
        technique->update(room.frame);
        const PointLights whole = renderPoints(device, *technique, all);
        for (const std::size_t number : {1u, 7u, 255u, 256u, 257u, 1000u}) {
            const std::size_t first = 311;
            const PointLights part = renderPoints(device, *technique, all.part(first, number));
            bool same = true;
            for (std::size_t i = 0; i < number; ++i) {
                same = same && std::equal(&part.irradiance[3 * i], &part.irradiance[3 * i] + 3, &whole.irradiance[3 * (first + i)]);
                same = same && part.validity[i] == whole.validity[first + i];
                for (std::size_t b = 0; b < 4; ++b) same = same && part.band(b, i) == whole.band(b, first + i);
            }
            CAPTURE(number);
            CHECK(same);
        }
    }
}

TEST_CASE("interleaving, filter, half resolution and history do not reach points", "[points]") {
    TestDevice device(16);
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    const auto reference = rsmOf(256, 1).make(device);
    reference->update(room.frame);
    const PointLights expected = renderPoints(device, *reference, list);
    for (const std::uint32_t n : {2u, 4u, 8u}) {
        const auto technique = rsmOf(256, n).make(device);
        technique->update(room.frame);
        const PointLights got = renderPoints(device, *technique, list);
        // The same VPLs, added up in the order in which pixels share them out.
        for (std::size_t i = 0; i < list.count(); ++i) {
            CHECK(got.e(i) == Approx(expected.e(i)).epsilon(2e-5).margin(1e-7));
            CHECK(got.band(0, i) == Approx(expected.band(0, i)).epsilon(2e-5).margin(1e-7));
        }
    }
    const auto one = ssvpOf(LW_VISIBILITY_HARD, 2, 1, 1).make(device), four = ssvpOf(LW_VISIBILITY_HARD, 2, 1, 4).make(device);
    one->update(room.frame);
    four->update(room.frame);
    const PointLights a = renderPoints(device, *one, list), b = renderPoints(device, *four, list);
    CHECK(a.irradiance == b.irradiance);
    CHECK(a.harmonics == b.harmonics);
}

TEST_CASE("propagated light in two bands is what surfaces read", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    const auto technique = lpvOf(LW_LPV_TRANSPORT_PROPAGATE).make(device);
    technique->update(room.frame);
    const PointLights points = renderPoints(device, *technique, list);
    double largest = 0.0;
    for (std::size_t i = 0; i < list.count(); ++i) largest = std::max(largest, points.e(i));
    for (std::size_t i = 0; i < list.count(); ++i) {
        const Vec n{list.normals[3 * i], list.normals[3 * i + 1], list.normals[3 * i + 2]};
        if (points.validity[i] == 0.0f) continue;
        CHECK(std::abs(points.fromBands(i, n) - points.e(i)) < 2e-6 * largest);
    }
}

TEST_CASE("a small VPL far away: both bands and every normal in closed form", "[points]") {
    TestDevice device(16);
    const Vec source{0.3, -0.2, 0.1};
    LWVpl vpl{};
    vpl.position[0] = float(source.x), vpl.position[1] = float(source.y), vpl.position[2] = float(source.z);
    vpl.normal[1] = 1.0f;
    vpl.area = 1e-6f;
    vpl.flux[0] = 5.0f;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.vpls = &vpl;
    frame.vplCount = 1;
    PointList list;
    for (const Vec& p : {Vec{0.3, 1.8, 0.1}, Vec{2.0, 1.0, -1.0}, Vec{-5.0, 0.5, 3.0}, Vec{0.0, -1.0, 0.0}})
        for (const Vec& n : {Vec{0, -1, 0}, Vec{0.6, 0, 0.8}, Vec{0, 1, 0}}) list.add(p, n);
    for (const Maker& maker : {rsmOf(256, 1), ssvpOf(LW_VISIBILITY_HARD, 1)}) {
        CAPTURE(maker.name);
        const auto technique = maker.make(device);
        technique->update(frame);
        const PointLights points = renderPoints(device, *technique, list);
        const PointLights places = renderPoints(device, *technique, list, kPointHarmonics | kPointValidity, false);
        CHECK(places.harmonics == points.harmonics);
        CHECK(places.validity == points.validity);
        for (std::size_t i = 0; i < list.count(); ++i) {
            const Vec at{list.positions[3 * i], list.positions[3 * i + 1], list.positions[3 * i + 2]},
                n{list.normals[3 * i], list.normals[3 * i + 1], list.normals[3 * i + 2]};
            const Vec to = source - at, d = unit(to);
            const double facing = std::max(0.0, -d.y) * 5.0 / (kPi * dot(to, to));
            CAPTURE(i);
            CHECK(points.band(0, i) == Approx(kY0 * facing).epsilon(1e-4));
            CHECK(points.c1(i).x == Approx(kY1 * facing * d.x).epsilon(1e-4).margin(1e-7));
            CHECK(points.c1(i).y == Approx(kY1 * facing * d.y).epsilon(1e-4).margin(1e-7));
            CHECK(points.c1(i).z == Approx(kY1 * facing * d.z).epsilon(1e-4).margin(1e-7));
            CHECK(points.e(i) == Approx(facing * std::max(0.0, dot(d, n))).epsilon(1e-4).margin(1e-7));
            // What two bands make of one direction: 1/4 + cos/2 of it, never further than 1/4 off.
            CHECK(points.fromBands(i, n) == Approx(std::max(0.0, facing * (0.25 + 0.5 * dot(d, n)))).epsilon(1e-4).margin(1e-7));
            CHECK(std::abs(points.fromBands(i, n) - points.e(i)) <= 0.2501 * facing);
            CHECK(points.band(0, i, 1) == 0.0);
        }
    }
}

// All six walls of the cube from -1 to 1 with exitance 1: the radiance is 1/pi from every direction.
TEST_CASE("a furnace: c0 = 4 Y0, c1 = 0, irradiance 1 on every normal", "[points]") {
    TestDevice device(16);
    constexpr int kAlong = 32;
    std::vector<LWVpl> vpls;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (int k = 0; k < kAlong * kAlong; ++k) {
                LWVpl vpl{};
                vpl.position[axis] = float(side);
                vpl.position[(axis + 1) % 3] = float((k % kAlong + 0.5) * 2.0 / kAlong - 1.0);
                vpl.position[(axis + 2) % 3] = float((k / kAlong + 0.5) * 2.0 / kAlong - 1.0);
                vpl.normal[axis] = float(-side);
                vpl.area = vpl.flux[0] = vpl.flux[1] = vpl.flux[2] = float(4.0 / (kAlong * kAlong));
                vpls.push_back(vpl);
            }
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.vpls = vpls.data();
    frame.vplCount = std::uint32_t(vpls.size());
    PointList list;
    for (const Vec& n : {Vec{1, 0, 0}, Vec{0, -1, 0}, Vec{0.6, 0, 0.8}, unit(Vec{1, 1, 1}), unit(Vec{-1, 2, -3})})
        for (const Vec& p : {Vec{0, 0, 0}, Vec{0.3, -0.2, 0.4}, Vec{-0.5, 0.45, 0.1}}) list.add(p, n);
    struct Case {
        Maker maker;
        double tolerance;  // of VPLs for squares half a unit away; of sweeps' directions and of light that starts a cell early
    };
    for (const Case& c : {Case{rsmOf(0, 1), 0.003}, Case{ssvpOf(LW_VISIBILITY_NONE, 1), 0.003}, Case{lpvOf(LW_LPV_TRANSPORT_SWEEP), 0.02}}) {
        CAPTURE(c.maker.name);
        const auto technique = c.maker.make(device);
        technique->update(frame);
        for (const bool hasNormals : {true, false}) {
            const PointLights points = renderPoints(device, *technique, list, hasNormals ? unsigned(kPointAll) : unsigned(kPointHarmonics | kPointValidity), hasNormals);
            for (std::size_t i = 0; i < list.count(); ++i) {
                const Vec n{list.normals[3 * i], list.normals[3 * i + 1], list.normals[3 * i + 2]};
                CAPTURE(i, hasNormals);
                CHECK(points.band(0, i) == Approx(4.0 * kY0).epsilon(c.tolerance));
                CHECK(std::sqrt(dot(points.c1(i), points.c1(i))) < c.tolerance * 4.0 * kY0);
                CHECK(points.fromBands(i, n) == Approx(1.0).epsilon(2.0 * c.tolerance));
                if (hasNormals) CHECK(points.e(i) == Approx(1.0).epsilon(2.0 * c.tolerance));
                CHECK(points.validity[i] == 1.0f);
            }
        }
    }
}

TEST_CASE("sweeps: six sides as two bands; outside of the grid there is nothing", "[points]") {
    TestDevice device(16);
    const Room room;
    const auto technique = lpvOf(LW_LPV_TRANSPORT_SWEEP).make(device);
    technique->update(room.frame);
    // In the middle of the room, whose floor alone sends light: it comes from below.
    PointList list;
    for (const Vec& n : {Vec{0, -1, 0}, Vec{0, 1, 0}, Vec{1, 0, 0}}) list.add({0.0, 0.5, 0.5}, n);
    list.add({0.0, 50.0, 0.5}, {0, -1, 0});
    const PointLights places = renderPoints(device, *technique, list, kPointHarmonics | kPointValidity, false);
    CHECK(places.validity == std::vector<float>{1.0f, 1.0f, 1.0f, 0.0f});
    CHECK(technique->count("points_outside") == 1);
    CHECK(technique->count("rejected_points") == 0);
    CHECK(places.band(0, 3) == 0.0);
    const Vec c1 = places.c1(0);
    CHECK(c1.y < 0.0);
    CHECK(std::abs(c1.x) < 0.15 * -c1.y);
    // The vector of the light, exact: the polygon's irradiance from below less that from above, which is none; tiles are grey,
    // 0.6 on average, and the cells' light is that of half a cell nearer.
    const double below = polygonIrradiance({{-0.5, 0, 0}, {-0.5, 0, 1}, {0.5, 0, 1}, {0.5, 0, 0}}, {0, 0.5, 0.5}, {0, -1, 0}, 0.6);
    CHECK(-c1.y / kY1 == Approx(below).epsilon(0.03));
}
