// Technique static_vpl: which VPLs are kept, and the light of them all as no more than so many lights.
#include <catch2/catch.hpp>
#include <map>

#include "support/static_vpl_rig.h"

using namespace lightwell::test;

namespace {

// What lights send a surface, of the places' box's middle.
double lightAt(const std::vector<LWListedLight>& lights, const glm::dvec3& x, const glm::dvec3& n) {
    double sum = 0.0;
    for (const LWListedLight& light : lights)
        sum +=
            twinLight({vec(light.position), vec(light.axis), vec(light.flux), double(light.area)}, x, n);
    return sum;
}

double lightAt(const std::vector<StaticRig::Vpl>& vpls, const glm::dvec3& x, const glm::dvec3& n) {
    double sum = 0.0;
    for (const auto& vpl : vpls) sum += twinLight(vpl, x, n);
    return sum;
}

LWLight sweepingTorch(double angle) {
    return spotLight({2, 1.5, 2.5}, {std::cos(angle), -0.4, std::sin(angle)}, {30, 25, 20}, 0.3, 0.7);
}

}  // namespace

TEST_CASE("VPLs weaker than a share of the strongest are left out, with hysteresis", "[static_vpl]") {
    StaticRig rig(GENERATE(1u, 16u), staticDesc());
    StaticScene scene;
    // The first one sets the scale: intensity 1 / (2 pi). The second one's is `share` of it.
    const auto kept = [&](double share) {
        scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, 1, 0}, share)};
        scene.lights = {sunLight({0, -1, 0}, {1, 1, 1})};
        rig.update(scene);
        return rig.technique.count("kept_vpls") == 2;
    };
    CHECK(kept(1.5e-3));  // the first frame: as if it had been there
    CHECK(kept(1.01e-3));
    CHECK_FALSE(kept(0.99e-3));
    CHECK_FALSE(kept(1.5e-3));  // out: it must reach twice as much
    CHECK_FALSE(kept(1.99e-3));
    CHECK(kept(2.01e-3));
    CHECK(kept(1.01e-3));
    // The strongest counts as if nothing blocked its light.
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, 1, 0}, 0.5e-3)};
    scene.block({0, 1, 0}, 0.5);
    rig.update(scene);
    CHECK(rig.technique.count("kept_vpls") == 0);
    CHECK(rig.vpls().empty());
}

TEST_CASE("the source's absolute threshold", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.cullAbsolute = 0.01f;
    desc.hysteresis = 1.0f;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.lights = {sunLight({0, -1, 0}, {1, 1, 1})};
    const auto kept = [&](double intensity) {  // rho E A / pi
        scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}, intensity * kRigPi / 0.5)};
        rig.update(scene);
        return rig.technique.count("kept_vpls");
    };
    CHECK(kept(0.0101) == 1);
    CHECK(kept(0.0099) == 0);
    CHECK(kept(0.0101) == 1);
}

TEST_CASE("the list of lights has all flux, and no more than so many lights", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.lights = GENERATE(1u, 7u, 16u, 64u);
    desc.bounces = GENERATE(1u, 2u);
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(200, 11, {4, 3, 5}, 0.3);
    scene.lights = {sweepingTorch(0.4), pointLight({1, 2, 1}, {3, 4, 5})};
    for (int frame = 0; frame < 3; ++frame) {
        rig.update(scene);
        const auto lights = rig.lights();
        const auto vpls = rig.vpls();
        CHECK(lights.size() <= desc.lights);
        glm::dvec3 listed(0.0), all(0.0);
        double area = 0.0, expectedArea = 0.0;
        std::uint32_t members = 0;
        for (const LWListedLight& light : lights) {
            listed += vec(light.flux);
            area += double(light.area);
            members += light.vpls;
            CHECK(glm::length(vec(light.axis)) == Approx(1.0).epsilon(1e-5));
            CHECK(light.id < desc.lights);
            CHECK(vec(light.bakedFlux) == vec(light.flux));
            // A spot of 170 degrees, evenly bright, sends as much.
            CHECK(double(light.coneAngle) == Approx(85.0 * kRigPi / 180.0));
            CHECK(double(light.spotIntensity[1]) * 2.0 * kRigPi *
                      (1.0 - std::cos(double(light.coneAngle))) ==
                  Approx(double(light.flux[1])).epsilon(1e-5));
        }
        for (const auto& vpl : vpls) {
            all += vpl.flux;
            expectedArea += vpl.area;
        }
        CHECK(members == vpls.size());
        CHECK(area == Approx(expectedArea).epsilon(1e-5));
        for (int c = 0; c < 3; ++c) CHECK(listed[c] == Approx(all[c]).epsilon(1e-5));
    }
}

TEST_CASE("few VPLs are lights of their own, exactly", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    StaticScene scene;
    scene.vpls = roomOfPlaces(16, 12);
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 10, 10})};
    rig.update(scene);
    const auto lights = rig.lights();
    const auto vpls = rig.vpls();
    REQUIRE(lights.size() == vpls.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        CHECK(vec(lights[i].position) == vpls[i].position);
        CHECK(vec(lights[i].flux) == vpls[i].flux);
        CHECK(glm::length(vec(lights[i].axis) - vpls[i].normal) < 1e-6);
        CHECK(lights[i].vpls == 1);
    }
    // Fewer than the list may have, of more places: also those.
    scene.vpls = roomOfPlaces(40, 12);
    scene.lights = {spotLight({2, 1.5, 2.5}, {0.3, -1, 0}, {30, 25, 20}, 0.3, 0.5)};
    rig.update(scene);
    const auto kept = rig.vpls();
    REQUIRE(kept.size() < 16);
    CHECK(rig.lights().size() == kept.size());
    for (const LWListedLight& light : rig.lights()) CHECK(light.vpls == 1);
}

// A light that sweeps by a twentieth of a degree a frame: lights keep their numbers and hardly move;
// what all of them send surfaces in the room changes no more from frame to frame than what the VPLs
// themselves send, but for a VPL that changes its light now and then.
TEST_CASE("lights keep their numbers and change slowly", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.lights = 12;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(300, 13, {4, 3, 5}, 0.2);
    const std::vector<glm::dvec3> where = {{1, 1, 1}, {3, 2, 4}, {2, 0.5, 2.5}, {0.7, 2.2, 4.2}};
    std::map<std::uint32_t, glm::dvec3> before;
    std::vector<double> last;
    int moved = 0, seen = 0;
    double worst = 0.0, error = 0.0;
    for (int frame = 0; frame < 120; ++frame) {
        scene.lights = {sweepingTorch(0.4 + frame * kRigPi / 3600.0)};
        rig.update(scene);
        const auto lights = rig.lights();
        const auto vpls = rig.vpls();
        std::vector<double> now;
        for (const glm::dvec3& x : where) {
            const double listed = lightAt(lights, x, {0, 1, 0}), exact = lightAt(vpls, x, {0, 1, 0});
            now.push_back(listed);
            error = std::max(error, std::abs(listed / exact - 1.0));
        }
        if (frame > 10)
            for (std::size_t i = 0; i < now.size(); ++i)
                worst = std::max(worst, std::abs(now[i] / last[i] - 1.0));
        last = now;
        for (const LWListedLight& light : lights) {
            const auto old = before.find(light.id);
            if (frame > 10 && old != before.end()) {
                ++seen;
                moved += glm::length(old->second - vec(light.position)) > 0.3 ? 1 : 0;
            }
            before[light.id] = vec(light.position);
        }
    }
    CAPTURE(worst, error, moved, seen);
    CHECK(seen > 1000);
    CHECK(moved < seen / 100);
    CHECK(worst < 0.02);
    CHECK(error < 0.25);
}

TEST_CASE("the list says what it cannot do", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    std::uint32_t count = 99;
    LWListedLight light{};
    CHECK(lwReadLightList(rig.technique, &light, 1, &count) == LW_ERROR_NOT_UPDATED);
    lastError(rig.device);
    StaticScene scene;
    scene.vpls = roomOfPlaces(6, 1);
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 10, 10})};
    rig.update(scene);
    CHECK(lwReadLightList(rig.technique, &light, 1, &count) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("capacity: expected at least 6"));
    CHECK(lwReadLightList(rig.technique, nullptr, 8, &count) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwReadLightList(rig.technique, &light, 1, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    TestTechnique rsm(rig.device, desc);
    CHECK(lwReadLightList(rsm, &light, 1, &count) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(rig.device), Catch::Contains("static_vpl"));
    // Nothing lit: no lights, and no room needed.
    scene.lights.clear();
    rig.update(scene);
    CHECK(lwReadLightList(rig.technique, nullptr, 0, &count) == LW_SUCCESS);
    CHECK(count == 0);
}
