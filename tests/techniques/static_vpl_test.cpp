// Technique static_vpl: what lights make of places, against a serial twin and values known by formula.
#include <catch2/catch.hpp>

#include "support/static_vpl_rig.h"

using namespace lightwell::test;

namespace {

// Sums of a few dozen products in float, and the profile's arc cosine.
constexpr double kRounding = 2e-5;

std::vector<float> lampProfile(std::size_t count) {  // bright ahead, a ring, nothing behind
    std::vector<float> profile;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = kRigPi * double(i) / double(count - 1);
        profile.push_back(angle > 2.0 ? 0.0f : float(1.0 + 0.8 * std::cos(7.0 * angle)));
    }
    return profile;
}

// Lights of all kinds in a room, with a lamp's profile on one of them.
StaticScene furnished(const std::vector<float>& profile) {
    StaticScene scene;
    scene.vpls = roomOfPlaces(37, 5);
    scene.lights = {sunLight({0.3, -1.0, 0.4}, {3, 2, 1}), pointLight({2, 1.5, 2.5}, {10, 12, 14}),
                    spotLight({1, 2.5, 1}, {0.5, -1, 0.7}, {40, 30, 20}, 0.3, 0.9),
                    pointLight({3, 2, 4}, {5, 5, 5})};
    put(scene.lights[3].direction, {0, -1, 0.3});
    scene.lights[3].profile = profile.data();
    scene.lights[3].profileCount = std::uint32_t(profile.size());
    for (int i = 0; i < 5; ++i)
        scene.block({0.6 + 0.7 * i, 0.4 + 0.45 * i, 4.2 - 0.75 * i}, 0.4 + 0.1 * i);
    return scene;
}

}  // namespace

TEST_CASE("flux of static VPLs is the serial twin's", "[static_vpl]") {
    StaticRig rig(GENERATE(1u, 16u), keepAll());
    const std::vector<float> profile = lampProfile(61);
    const StaticScene scene = furnished(profile);
    rig.update(scene);
    const auto flux = rig.flux();
    REQUIRE(flux.size() == scene.vpls.size());
    double mean = 0.0;
    std::vector<glm::dvec3> expected;
    for (const LWStaticVpl& vpl : scene.vpls) {
        glm::dvec3 e(0.0);
        for (const LWLight& light : scene.lights) e += twinIrradiance(scene, vpl, light);
        expected.push_back(e * vec(vpl.reflectance) * double(vpl.weight));
        mean += (expected.back().x + expected.back().y + expected.back().z) / 3.0 /
                double(scene.vpls.size());
    }
    for (std::size_t i = 0; i < flux.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            CAPTURE(i, c, flux[i][c], expected[i][c]);
            CHECK(std::abs(flux[i][c] - expected[i][c]) <= kRounding * (expected[i][c] + mean));
        }
}

TEST_CASE("one place, one light: inverse squares, cosines, cones, pi", "[static_vpl]") {
    StaticRig rig(16, keepAll());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}, 0.5, {0.8, 0.4, 0.2})};
    const auto flux = [&](const LWLight& light) {
        scene.lights = {light};
        rig.update(scene);
        return rig.flux()[0].x;
    };
    // rho A I / d^2, and with the cosine of 60 degrees at the place.
    CHECK(flux(pointLight({0, 2, 0}, {12, 12, 12})) == Approx(0.8 * 0.5 * 12.0 / 4.0).epsilon(1e-6));
    CHECK(flux(pointLight({std::sqrt(3.0), 1, 0}, {12, 12, 12})) ==
          Approx(0.8 * 0.5 * 12.0 / 4.0 * 0.5).epsilon(1e-6));
    CHECK(flux(pointLight({0, -2, 0}, {12, 12, 12})) == 0.0);  // behind
    CHECK(flux(sunLight({0, -3, 0}, {7, 7, 7})) == Approx(0.8 * 0.5 * 7.0).epsilon(1e-6));
    // Half-way between the cosines of its cones a spot sends a quarter.
    const double middle = std::acos(0.5 * (std::cos(0.2) + std::cos(0.8)));
    CHECK(flux(spotLight({0, 2, 0}, {std::sin(middle), -std::cos(middle), 0}, {12, 12, 12}, 0.2, 0.8)) ==
          Approx(0.25 * 0.8 * 0.5 * 3.0).epsilon(1e-5));
    CHECK(flux(spotLight({0, 2, 0}, {0, -1, 0}, {12, 12, 12}, 0.2, 0.8)) ==
          Approx(0.8 * 0.5 * 3.0).epsilon(1e-6));
    CHECK(flux(spotLight({0, 2, 0}, {0, 1, 0}, {12, 12, 12}, 0.2, 0.8)) == 0.0);
    // A profile's steps at 0, 90 and 180 degrees: the place is seen at 45.
    LWLight lamp = pointLight({1, 1, 0}, {12, 12, 12});
    put(lamp.direction, {0, -1, 0});
    const float profile[3] = {1.0f, 0.2f, 5.0f};
    lamp.profile = profile;
    lamp.profileCount = 3;
    CHECK(flux(lamp) == Approx(0.6 * 0.8 * 0.5 * 12.0 / 2.0 * std::sqrt(0.5)).epsilon(1e-5));
    // unitArea: m^2 of a weight of 1.
    LWStaticVplDesc desc = keepAll();
    desc.unitArea = 3.0f;
    StaticRig larger(16, desc);
    scene.lights = {sunLight({0, -3, 0}, {7, 7, 7})};
    larger.update(scene);
    CHECK(larger.flux()[0].y == Approx(0.4 * 1.5 * 7.0).epsilon(1e-6));
}

TEST_CASE("a place beside a light reflects no more than a hemisphere of its light", "[static_vpl]") {
    StaticRig rig(16, keepAll());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}, 4.0, glm::dvec3(1.0))};
    for (const double distance : {1.0, 0.1, 1e-6, 0.0}) {
        scene.lights = {pointLight({0, distance, 0}, {2, 2, 2})};
        rig.update(scene);
        CAPTURE(distance);
        CHECK(rig.flux()[0].x <= 2.0 * 2.0 * kRigPi * 1.000001);
        CHECK(std::isfinite(rig.flux()[0].x));
    }
    // Without reaching it, the irradiance is that of the place itself.
    scene.lights = {pointLight({0, 1, 0}, {2, 2, 2})};
    rig.update(scene);
    CHECK(rig.flux()[0].x == Approx(8.0).epsilon(1e-6));
}

TEST_CASE("blockers dim softly what passes them", "[static_vpl]") {
    StaticRig rig(GENERATE(1u, 16u), keepAll());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0})};
    const bool sun = GENERATE(false, true);
    scene.lights = {sun ? sunLight({0, -1, 0}, {4, 4, 4}) : pointLight({0, 4, 0}, {64, 64, 64})};
    const auto flux = [&](const glm::dvec3& center, double radius) {
        scene.blockers.clear();
        scene.block(center, radius);
        rig.update(scene);
        return rig.flux()[0].x;
    };
    const double open = flux({50, 2, 0}, 1.0);
    CHECK(open == Approx(2.0).epsilon(1e-6));
    CHECK(flux({0, 2, 0}, 0.5) == 0.0);  // through the centre
    CHECK(flux({0.25, 2, 0}, 0.5) == Approx(open / 4.0).epsilon(1e-6));
    CHECK(flux({0.6, 2, 0}, 0.5) == open);  // farther than its radius: the same bits
    CHECK(flux({0, -1, 0}, 0.9) == open);   // behind the place
    CHECK(flux({0, -1, 0}, 2.0) == Approx(open / 4.0).epsilon(1e-6));  // ... reaching half-way round it
    CHECK(flux({0, 5, 0}, 0.9) == (sun ? 0.0 : open));  // beyond a lamp, but not beyond the sun
    CHECK(flux({0, 2, 0}, 0.0) == open);                // of no size
    // Overlapping ones multiply.
    scene.blockers.clear();
    scene.block({0.25, 2, 0}, 0.5);
    scene.block({-0.3, 1, 0}, 0.6);
    rig.update(scene);
    CHECK(rig.flux()[0].x == Approx(open / 16.0).epsilon(1e-6));
}

namespace {

// A room behind a wall in the plane z = 0 with a doorway, x from 0 to 1; the sun comes along +z. The
// wall's and the door's spheres lie half their radius apart: a path meets a dozen, which let e^-12
// through on average (the mean of ln d^2/r^2 over a disc is -1).
StaticScene doorway(double angle) {
    StaticScene scene;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 15; ++x)
            scene.vpls.push_back(staticVpl({-1.0 + 0.2 * x, 0.3 + 0.5 * y, 4.0}, {0, 0, -1}, 0.2));
    for (int x = 0; x < 15; ++x)
        scene.vpls.push_back(staticVpl({-1.0 + 0.2 * x, 0, 2.0}, {0, 1, -1e-3}, 0.2));
    // A place outside, which is the strongest when the door is shut.
    scene.vpls.push_back(staticVpl({0.5, 1, -3}, {0, 0, -1}, 0.5));
    scene.lights = {sunLight({0, -0.1, 1}, {10, 10, 10})};
    for (int y = -2; y < 16; ++y) {
        for (int x = 0; x < 9; ++x) {
            scene.block({-0.25 - 0.15 * x, 0.15 * y, 0}, 0.3);
            scene.block({1.25 + 0.15 * x, 0.15 * y, 0}, 0.3);
        }
        for (int s = 0; s < 8; ++s)
            scene.block({s / 7.0 * std::cos(angle), 0.15 * y, s / 7.0 * std::sin(angle)}, 0.3);
    }
    return scene;
}

}  // namespace

TEST_CASE("a shut door leaves a room dark; light grows as it opens", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    std::vector<double> total;
    for (int step = 0; step <= 9; ++step) {
        rig.update(doorway(step * kRigPi / 18.0));
        double sum = 0.0;
        const auto flux = rig.flux();
        for (std::size_t i = 0; i + 1 < flux.size(); ++i) sum += flux[i].x;
        total.push_back(sum);
        if (step == 0) {
            // All of the room's are culled: the one outside alone is kept.
            CHECK(rig.technique.count("kept_vpls") == 1);
            for (const auto& vpl : rig.vpls()) CHECK(vpl.position.z < 0.0);
        }
    }
    CAPTURE(total);
    CHECK(total.back() > 0.5);
    CHECK(total.front() <= 1e-3 * total.back());
    // But for what is as good as nothing: a door that swings brings its spheres closer together before
    // it lets light past.
    for (std::size_t i = 1; i < total.size(); ++i) CHECK(total[i] >= total[i - 1] - 1e-3 * total.back());
}

TEST_CASE("masks choose which lights light which places", "[static_vpl]") {
    StaticRig rig(16, keepAll());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, 1, 0}),
                  staticVpl({2, 0, 0}, {0, 1, 0})};
    scene.vpls[1].lightMask = 2;
    scene.vpls[2].lightMask = 5;
    scene.lights = {sunLight({0, -1, 0}, {1, 1, 1}), sunLight({0, -1, 0}, {10, 10, 10}),
                    sunLight({0, -1, 0}, {100, 100, 100})};
    scene.lights[0].mask = 1;
    scene.lights[1].mask = 2;
    rig.update(scene);
    const auto flux = rig.flux();
    CHECK(flux[0].x == Approx(0.5 * 111.0).epsilon(1e-6));
    CHECK(flux[1].x == Approx(0.5 * 110.0).epsilon(1e-6));
    CHECK(flux[2].x == Approx(0.5 * 101.0).epsilon(1e-6));
}

TEST_CASE("what cannot be is refused by name", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    StaticScene good;
    good.vpls = {staticVpl({0, 0, 0}, {0, 1, 0})};
    good.lights = {pointLight({0, 1, 0}, {1, 1, 1})};
    const auto refused = [&](const StaticScene& scene, const char* part) {
        CHECK(rig.tryUpdate(scene) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(rig.device), Catch::Contains(part));
    };
    StaticScene bad = good;
    bad.vpls[0].position[1] = NAN;
    refused(bad, "frame.staticVpls[0].position");
    bad = good;
    bad.vpls[0].normal[1] = 2.0f;
    refused(bad, "frame.staticVpls[0].normal");
    bad = good;
    bad.vpls[0].weight = -1.0f;
    refused(bad, "frame.staticVpls[0].weight");
    bad = good;
    bad.vpls[0].reflectance[2] = 1.5f;
    refused(bad, "frame.staticVpls[0].reflectance");
    bad = good;
    bad.vpls[0].receivers = 4;
    refused(bad, "frame.staticVpls[0].receivers");
    bad = good;
    const float profile[2] = {1.0f, -1.0f};
    bad.lights[0].profile = profile;
    bad.lights[0].profileCount = 2;
    refused(bad, "frame.lights[0].profile[1]");
    bad.lights[0].profileCount = 1;
    refused(bad, "frame.lights[0].profileCount");
    bad = good;
    bad.blockers.resize(1025);
    refused(bad, "frame.blockerCount");
    bad = good;
    bad.vpls.resize(4097, good.vpls[0]);
    refused(bad, "frame.staticVplCount");
    rig.update(good);
}
