// lwRenderPoints' two bands of spherical harmonics in closed form: one VPL, a furnace, a floor.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/points_makers.h"
#include "support/points_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 61, kHeight = 32;
constexpr double kPi = 3.14159265358979323846;

double tilesProfile(double x, double z) { return std::fmod(std::floor(x * 9.1) + std::floor(z * 9.1), 2.0) != 0.0 ? 0.2 : 1.0; }

struct Room : PointRoom {
    Room() : PointRoom(64, tilesProfile, kWidth, kHeight) {}
};

}  // namespace

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
